"""One stream on its way to an estimate: ordered, kept as raw records, shown as a recent run."""

import math
from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from statistics import median
from typing import Literal, Protocol

import numpy as np

from seatrial.core.results.online import Proposal, Sample, SampleCounts, Snapshot
from seatrial.core.text.words import counted
from seatrial.core.values import InputError, Record
from seatrial.data.check import canonical_record
from seatrial.data.read import Layout
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import Role, Trial
from seatrial.data.trial.settings import Stream
from seatrial.estimation.identify.online import OnlineEstimator, stream_run
from seatrial.onboard.journal import Journal, RunEntry
from seatrial.onboard.proposer import GainProposer

# Which samples of a stream are used: in order of time, each once; a break of the clock begins a new run.

# steps whose median is the nominal step where none is given; chosen: a few pauses among them do not move it
_FIRST_STEPS = 20
# share of a step within which two times are the same; chosen: above the rounding of a logger that writes four digits
_SAME_TIME = 1e-3
_LONGEST_GAP_S, _LONGEST_GAP_STEPS = 30.0, 5.0  # s, and steps of a slow stream, after which a new run begins; chosen


@dataclass(frozen=True)
class RunStart:
    """A new run begins with the next sample, whose time [s] this is."""

    time: float
    reason: str


StreamEvent = Sample | RunStart


class SampleOrder:
    """Puts a stream in order, in constant memory.

    A sample up to `late_s` older than the newest is late, one of the same time repeated; both are dropped. One older
    still, or more than `longest_gap_s` ahead, is suspect until the next arrives: if that continues from it, the clock
    has jumped and a new run begins with it; if that continues from before, the time stamp was wrong and the sample is
    dropped, as late or, if ahead, as garbled. Missing steps are counted from `dt`, or from the median of the first
    twenty steps. Values that are not finite become NaN.

    Args:
        dt: s, nominal step; None: from the stream.
        longest_gap_s: s; late_s: s by which a stamp may be behind and still belong to the same clock.
    """

    def __init__(self, dt: float | None, longest_gap_s: float, *, late_s: float = 5.0) -> None:  # seconds, chosen
        self._dt = dt
        self._longest_gap, self._late_s = longest_gap_s, late_s
        self._newest_time = -math.inf
        self._suspect: Sample | None = None
        self._steps: list[float] = []
        self._accepted = self._not_finite = self._missing = 0
        self._fault_counts = SampleCounts()

    @property
    def dt(self) -> float | None:
        """Nominal step [s]; None before it is known."""
        return self._dt

    @property
    def counts(self) -> SampleCounts:
        """Counts of the samples; a suspect one is not yet counted."""
        return replace(self._fault_counts, accepted=self._accepted, not_finite=self._not_finite, missing=self._missing)

    def admit(self, sample: Sample) -> list[StreamEvent]:
        """Return what follows from a sample: nothing, the sample, or a new run that begins with it or a suspect one."""
        time, suspect = sample.time, self._suspect
        if not math.isfinite(time):
            return self._dropped("garbled", "a sample without a time")
        step = time - self._newest_time
        if step == math.inf:
            return self._start_run(sample, "the stream begins")
        if suspect is not None and abs(time - suspect.time) < abs(step):
            return self._resolve_suspect(suspect, sample)
        if abs(step) <= _SAME_TIME * (self._dt or 0.0):
            return self._dropped("repeated", f"t = {time:g} s twice")
        if 0.0 < step <= self._longest_gap:
            self.drop_suspect()
            return self._continue_run(sample, step)
        if -self._late_s <= step < 0.0:
            return self._dropped("late", f"t = {time:g} s arrived after {self._newest_time:g} s")
        self.drop_suspect()
        self._suspect = sample
        return []

    def _resolve_suspect(self, suspect: Sample, sample: Sample) -> list[StreamEvent]:
        step = sample.time - suspect.time
        if abs(step) <= _SAME_TIME * (self._dt or 0.0):
            return self._dropped("repeated", f"t = {sample.time:g} s twice")
        if -self._late_s <= step < 0.0:
            return self._dropped("late", f"t = {sample.time:g} s arrived after {suspect.time:g} s")
        if not 0.0 < step <= self._longest_gap:
            self.drop_suspect()
            self._suspect = sample
            return []
        reason = f"the clock jumped from {self._newest_time:g} s to {suspect.time:g} s"
        self._fault_counts = replace(self._fault_counts, jumps=self._fault_counts.jumps + 1, last_problem=reason)
        self._suspect = None
        return [*self._start_run(suspect, reason), *self._continue_run(sample, step)]

    def _start_run(self, sample: Sample, reason: str) -> list[StreamEvent]:
        return [RunStart(sample.time, reason), *self._accept(sample)]

    def _continue_run(self, sample: Sample, step: float) -> list[StreamEvent]:
        if self._dt is not None:
            self._missing += _missing_steps(step, self._dt)
        else:
            self._steps.append(step)
            if len(self._steps) == _FIRST_STEPS:
                self._dt = median(self._steps)
                self._missing += sum(_missing_steps(one, self._dt) for one in self._steps)
                self._steps.clear()
        return self._accept(sample)

    def _accept(self, sample: Sample) -> list[StreamEvent]:
        self._newest_time = sample.time
        self._accepted += 1
        if np.isfinite(sample.values).all():
            return [sample]
        self._not_finite += 1
        if not np.isinf(sample.values).any():
            return [sample]
        return [Sample(sample.time, np.where(np.isfinite(sample.values), sample.values, np.nan))]

    def drop_suspect(self) -> None:
        """Drop and count a sample that is still suspect, as at the end of the stream."""
        if self._suspect is None:
            return
        time, self._suspect = self._suspect.time, None
        if time < self._newest_time:
            self._dropped("late", f"t = {time:g} s arrived after {self._newest_time:g} s")
        else:
            self._dropped("garbled", f"no sample followed t = {time:g} s, far ahead of {self._newest_time:g} s")

    def _dropped(self, fault: Literal["late", "repeated", "garbled"], message: str) -> list[StreamEvent]:
        """Count a sample that is not used; nothing follows from it."""
        count = {fault: getattr(self._fault_counts, fault) + 1}
        self._fault_counts = replace(self._fault_counts, last_problem=message, **count)
        return []


def combined_counts(*parts: SampleCounts) -> SampleCounts:
    """Return the counts of a source and of the orderings behind it as one."""
    names = [field.name for field in fields(SampleCounts) if field.name != "last_problem"]
    sums = {name: sum(getattr(part, name) for part in parts) for name in names}
    return SampleCounts(**sums, last_problem="; ".join(part.last_problem for part in parts if part.last_problem))


def _missing_steps(step: float, dt: float) -> int:
    return max(round(step / dt) - 1, 0)


# Samples as raw records, as a file of the same lines would have given them.

# a record needs a time step
_MIN_SAMPLES = 2


class RunBuffer:
    """Keeps every sample accepted, run by run, at eight bytes a number."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._runs: list[tuple[str, array[float]]] = []

    def start_run(self, name: str) -> None:
        """Begin a run."""
        self._runs.append((name, array("d")))

    def add(self, sample: Sample) -> None:
        """Append a sample to the run begun last."""
        rows = self._runs[-1][1]
        rows.append(sample.time)
        rows.frombytes(sample.values.tobytes())

    def records(self, behind: float = -math.inf) -> tuple[Record, ...]:
        """Return the runs of two samples and more as records, in order; behind: a time of the stream's clock [s]."""
        width = 1 + len(self._layout.columns)
        tables = [(name, np.frombuffer(rows, dtype=np.float64).reshape(-1, width)) for name, rows in self._runs]
        tables = [(name, table[table[:, 0] > behind]) for name, table in tables]
        return tuple(
            record_from_values(name, self._layout, table[:, 0], table[:, 1:])
            for name, table in tables
            if len(table) >= _MIN_SAMPLES
        )


def with_training_records(trial: Trial, records: tuple[Record, ...], *, has_changed: bool = False) -> Trial:
    """Return the trial with these records as training runs, behind its own and before all other runs.

    has_changed: whether they are of another ship than its own training runs, which are then left out.
    """
    came = tuple(stream_run(trial, record) for record in records)
    others = tuple(run for run in trial.runs if run.role is not Role.TRAIN)
    return replace(trial, runs=(*(() if has_changed else trial.runs_with_role(Role.TRAIN)), *came, *others))


# The run so far as a record for people: thinned, so that a day of samples fits a screen.

# samples kept at most; chosen: more than a plot on a screen has columns
MAX_SAMPLES = 600


class RecentRun:
    """Every `stride`-th sample of a run and the newest; the stride doubles when there are too many."""

    def __init__(self, layout: Layout, limit: int = MAX_SAMPLES) -> None:
        self._layout, self._limit = layout, limit
        self.start_run()

    def start_run(self) -> None:
        """Forget the run before."""
        self._kept: list[Sample] = []
        self._newest: Sample | None = None
        self._count, self._stride = 0, 1

    def add(self, sample: Sample) -> None:
        """Append a sample."""
        self._newest = sample
        if self._count % self._stride == 0:
            self._kept.append(sample)
        self._count += 1
        if len(self._kept) > self._limit:
            self._kept, self._stride = self._kept[::2], 2 * self._stride

    def records(self) -> tuple[Record, ...]:
        """Return the run, in canonical frames and signs where the channels allow it; empty for too few samples."""
        newest = [] if self._newest is None or self._kept[-1] is self._newest else [self._newest]
        samples = [*self._kept, *newest]
        if len(samples) < _MIN_SAMPLES:
            return ()
        time = np.array([sample.time for sample in samples])
        try:
            record = record_from_values("run", self._layout, time, np.array([sample.values for sample in samples]))
        except InputError:
            return ()
        try:
            return (canonical_record(record),)
        except InputError:
            return (record,)


# One stream on its way to an estimate: ordered, journalled, kept where a fit is made of it at the end.

# messages kept; chosen: more would only repeat the same trouble
_MAX_MESSAGES = 20
# samples processed at once where so many wait; chosen: a few milliseconds, and ten seconds at 10 Hz
_MAX_BLOCK = 100
_REFUSALS = (InputError, np.linalg.LinAlgError, ArithmeticError)
# written into journals: not to be changed
_RESTART_REASON = "followed again"


class StreamEstimator(Protocol):
    """Makes estimates from samples; it has no thread and no clock of its own."""

    def begin_run(self) -> None:
        """Begin a run with the next sample."""
        ...

    def update(self, sample: Sample) -> Snapshot:
        """Take in a sample and return the snapshot after it."""
        ...


class StreamSession:
    """Takes samples in and holds the newest snapshot.

    Attributes:
        snapshot: the newest; None before the first sample.
        last_journalled: the last sample of the journal, if any.
        recent_run: the run so far, for people.
        messages: errors of the estimator and of the journal, in words, each once.
    """

    def __init__(
        self,
        stream: Stream,
        estimator: StreamEstimator,
        journal: Journal | None,
        buffer: RunBuffer | None,
        proposer: GainProposer | None = None,
    ) -> None:
        self.snapshot: Snapshot | None = None
        self.last_journalled: Sample | None = None
        self.messages: list[str] = []
        self._name, self._estimator, self._journal, self._buffer = stream.name, estimator, journal, buffer
        self._proposer = proposer
        self._stream, self._order, self._earlier_counts = stream, _sample_order(stream), SampleCounts()
        self._run_count, self._restarts = 0, False
        self.recent_run = RecentRun(stream.layout)
        self._estimator_error = ""

    def journal_events(self, journal: Journal, *, continues: bool) -> Iterator[StreamEvent]:
        """Yield the events of the journal, in order; they are not written again.

        continues: whether the samples to come go on where the journal ends; otherwise they may be admitted meanwhile.
        """
        order = self._order if continues else _sample_order(self._stream)
        for entry in journal.entries():
            if isinstance(entry, Sample):
                self.last_journalled = entry
                yield from order.admit(entry)
            elif entry.reason == _RESTART_REASON:
                self._earlier_counts = combined_counts(self._earlier_counts, order.counts)
                order = _sample_order(self._stream)
        if continues:
            self._order = order
        else:
            self._earlier_counts = combined_counts(self._earlier_counts, order.counts)
        if journal.torn_bytes:
            torn = f"the last {journal.torn_bytes} bytes of '{journal.path.name}'"
            self._add_message(f"{torn} were incomplete after a break and were cut off")
        if journal.damaged_places:
            places = counted(journal.damaged_places, "damaged place")
            self._add_message(f"{places} of '{journal.path.name}' cost the samples there and were skipped")

    def admit(self, samples: Iterable[Sample]) -> list[StreamEvent]:
        """Return the events that follow from these samples, written to the journal first."""
        events = [event for sample in samples for event in self._order.admit(sample)]
        if self._journal is not None:
            if events and self._restarts:
                self._journal.append(RunEntry(_RESTART_REASON))
                self._restarts = False
            for event in events:
                self._journal.append(RunEntry(event.reason) if isinstance(event, RunStart) else event)
            self._journal.write_pending()
        return events

    def process(self, event: StreamEvent) -> None:
        """Update the estimate with an event; what the estimator refuses becomes a message, and the next may succeed."""
        if not isinstance(event, RunStart):
            self.process_samples([event])
            return
        try:
            self._start_run()
        except _REFUSALS as error:
            self._note_refusal(event.time, error)

    @property
    def block_size(self) -> int:
        """Number of samples that are processed at once, at most: one where something is made of each of them."""
        is_single = self._proposer is not None or not isinstance(self._estimator, OnlineEstimator)
        return 1 if is_single else _MAX_BLOCK

    def process_samples(self, samples: Sequence[Sample]) -> None:
        """Update the estimate with successive samples of a run, at most `block_size` at once."""
        size = self.block_size
        for first in range(0, len(samples), size):
            block = samples[first : first + size]
            try:
                self._process_block(block)
            except _REFUSALS as error:
                self._note_refusal(block[-1].time, error)

    def _process_block(self, block: Sequence[Sample]) -> None:
        for sample in block:
            if self._buffer is not None:
                self._buffer.add(sample)
            self.recent_run.add(sample)
            if self._proposer is not None:
                self._proposer.add(sample)
        if isinstance(self._estimator, OnlineEstimator):
            times, values = np.array([s.time for s in block]), np.array([s.values for s in block])
            self.snapshot = self._estimator.update_block(times, values)
        else:
            self.snapshot = self._estimator.update(block[0])

    def _note_refusal(self, time: float, error: Exception) -> None:
        self._estimator_error = f"t = {time:g} s: {error}"
        self._add_message(str(error))

    @property
    def proposal(self) -> Proposal | None:
        """Return the newest proposal of gains; None where none is required, or before the first."""
        return None if self._proposer is None else self._proposer.proposal

    def restart(self) -> None:
        """Begin a run with the next sample, whatever its time: its positions may have another origin than before."""
        self._reset_order()
        self._restarts = True

    def finish(self) -> None:
        """End the stream."""
        self._order.drop_suspect()

    def counts(self, source: SampleCounts) -> SampleCounts:
        """Return the counts of the source and the ordering together, with the estimator's latest error in words."""
        estimator_error = SampleCounts(last_problem=self._estimator_error)
        return combined_counts(source, self._earlier_counts, self._order.counts, estimator_error)

    def _reset_order(self) -> None:
        self._earlier_counts = combined_counts(self._earlier_counts, self._order.counts)
        self._order = _sample_order(self._stream)

    def _start_run(self) -> None:
        self._run_count += 1
        if self._buffer is not None:
            self._buffer.start_run(self._name if self._run_count == 1 else f"{self._name}_{self._run_count}")
        self.recent_run.start_run()
        if self._proposer is not None:
            self._proposer.start_run()
        self._estimator.begin_run()

    def _add_message(self, text: str) -> None:
        if text not in self.messages and len(self.messages) < _MAX_MESSAGES:
            self.messages.append(text)


def _sample_order(stream: Stream) -> SampleOrder:
    dt = 1.0 / stream.rate
    return SampleOrder(dt, max(_LONGEST_GAP_S, _LONGEST_GAP_STEPS * dt))
