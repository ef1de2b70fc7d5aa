"""The samples that are kept, run by run, as raw rows and as canonical records."""

from dataclasses import dataclass

from seatrial.core.results.online import Sample
from seatrial.core.values import Record
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import Role, Trial, TrialRun
from seatrial.data.trial.records import load_run
from seatrial.data.trial.runs import require_stream
from seatrial.estimation.estimate.online.sample_rows import SampleRows

# a run of fewer samples is left out: no slope can be taken from it
MIN_RUN_SAMPLES = 3


@dataclass(frozen=True, eq=False)
class _StreamRun:
    """A run of the stream: its number, counted from 1, and its rows."""

    number: int
    rows: SampleRows


@dataclass(frozen=True, eq=False)
class _ClosedRun:
    """A run that has ended: as received, and as a canonical record."""

    raw_record: Record
    record: Record


class StreamWindow:
    """Grows with each sample and is emptied when its information is carried on elsewhere.

    A trial's own training runs come first and count until then.

    Raises:
        InputError: the trial has no [follow], or its own records do not pass.
    """

    def __init__(self, trial: Trial) -> None:
        self._trial, self._stream = trial, require_stream(trial)
        self._trial_records = tuple(
            load_run(run, trial.reference_point).record for run in trial.runs if run.role is Role.TRAIN
        )
        self._closed: list[_ClosedRun] = []
        self._closed_seconds, self._closed_samples = 0.0, 0
        self._open: _StreamRun | None = None

    @property
    def has_run(self) -> bool:
        """Whether a run has begun."""
        return self._open is not None

    @property
    def open_samples(self) -> int:
        """Number of samples kept of the present run."""
        return 0 if self._open is None else len(self._open.rows)

    @property
    def samples(self) -> int:
        """Number of samples kept of the stream."""
        return self._closed_samples + self.open_samples

    @property
    def seconds(self) -> float:
        """Sum of the durations of the stream's runs kept, s."""
        return self._closed_seconds + (0.0 if self._open is None else self._open.rows.duration)

    def begin_run(self, number: int) -> None:
        """Close the present run and open the next; a closed run too short for a record is left out.

        Raises:
            InputError: the closed run cannot be used (too short for its waves, say); the next one is open nevertheless.
        """
        ended = self._open
        self._open = self._empty_run(number)
        if ended is None or len(ended.rows) < MIN_RUN_SAMPLES:
            return
        raw_record = self._raw_record(ended)
        self._closed.append(_ClosedRun(raw_record, self._canonical_record(raw_record)))
        self._closed_seconds += ended.rows.duration
        self._closed_samples += len(ended.rows)

    def add(self, sample: Sample) -> None:
        """Append a sample to the present run.

        Raises:
            RuntimeError: no run has begun.
        """
        if self._open is None:
            raise RuntimeError("a sample came before a run began; call begin_run first")
        self._open.rows.add(sample.time, sample.values)

    def clear(self) -> None:
        """Forget all samples and the trial's own records; the present run goes on."""
        self._trial_records, self._closed = (), []
        self._closed_seconds, self._closed_samples = 0.0, 0
        self._open = None if self._open is None else self._empty_run(self._open.number)

    def records(self) -> list[Record]:
        """Return the records kept, in canonical frames and signs: the trial's own, closed runs, the present one.

        Raises:
            InputError: the present run is too short to be read as a record.
        """
        present = [self._canonical_record(raw) for raw in self._present_record()]
        return [*self._trial_records, *(run.record for run in self._closed), *present]

    def training_runs(self) -> tuple[TrialRun, ...]:
        """Return the stream's runs kept, as received, as training runs of a trial."""
        return tuple(
            self._training_run(raw) for raw in (*(run.raw_record for run in self._closed), *self._present_record())
        )

    def _empty_run(self, number: int) -> _StreamRun:
        return _StreamRun(number, SampleRows(len(self._stream.layout.columns)))

    def _present_record(self) -> tuple[Record, ...]:
        """The present run as received; empty while it is too short."""
        if self._open is None or len(self._open.rows) < MIN_RUN_SAMPLES:
            return ()
        return (self._raw_record(self._open),)

    def _raw_record(self, run: _StreamRun) -> Record:
        name = self._stream.name if run.number <= 1 else f"{self._stream.name}_{run.number}"
        return record_from_values(name, self._stream.layout, run.rows.time, run.rows.values)

    def _training_run(self, raw_record: Record) -> TrialRun:
        return TrialRun(raw_record, waves=self._stream.waves)

    def _canonical_record(self, raw_record: Record) -> Record:
        record = load_run(self._training_run(raw_record), self._trial.reference_point).record
        rate = self._trial.estimate.rate
        return record if rate is None else record.resampled(rate)
