"""One estimator fed sample by sample: the criterion of `identify` over a window, then carried information."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.online import CoefficientChange, Sample, Snapshot
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.phases import begins_before_release, is_free_decay
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import Role, Run, Trial, Trimming
from seatrial.data.trial.records import load_run
from seatrial.data.trial.runs import require_stream
from seatrial.estimation.estimate.criterion_choice import is_explained
from seatrial.estimation.estimate.online.change_detector import ChangeDetector, GaussianEstimate
from seatrial.estimation.estimate.online.window import SampleRows, WindowEstimate
from seatrial.estimation.identify.online.phases import (
    BLOCK_SAMPLES,
    CONTINUED_INTERVALS,
    REPEATED_INTERVALS,
    Carried,
    ContinuedSearch,
    KeptPhase,
    RecursivePhase,
    RepeatedSearch,
    SearchSchedule,
    StreamProgress,
    WarmUp,
    Window,
    WindowSearch,
    at_progress,
    carried_phase,
    filter_phase,
    first_snapshot,
    is_window_full,
    recursive_snapshot,
    snapshot_of_now,
    suits_whole_runs,
    window_snapshot,
)

# The samples that are kept, run by run, as raw rows and as canonical records.

# a run of fewer samples is left out: no slope can be taken from it
MIN_RUN_SAMPLES = 3


def stream_run(trial: Trial, raw_record: Record) -> Run:
    """Return a run of the trial's stream, as received, as a training run; one held before its release begins there."""
    is_held = _is_undriven(trial.model, raw_record) and begins_before_release(raw_record)
    return Run(raw_record, waves=require_stream(trial).waves, trimming=Trimming(from_release=is_held))


def _is_undriven(model: Model, record: Record) -> bool:
    """Whether nothing is recorded that moves a model which swings, so that it can only be released."""
    return not model.has_course and not {*model.input_names} & {*record.channels}


@dataclass(frozen=True, eq=False)
class _StreamRun:
    """A run of the stream: its number, counted from 1, and its rows."""

    number: int
    rows: SampleRows


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
        self._closed: list[tuple[Record, Record]] = []  # as received, and as a canonical record
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
        self._closed.append((raw_record, self._canonical_record(raw_record)))
        self._closed_seconds += ended.rows.duration
        self._closed_samples += len(ended.rows)

    def add(self, times: Array, values: Array) -> None:
        """Append samples to the present run: times (n,), s, values (n, columns).

        Raises:
            RuntimeError: no run has begun.
        """
        if self._open is None:
            raise RuntimeError("a sample came before a run began; call begin_run first")
        self._open.rows.add(times, values)

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
        return [*self._trial_records, *(record for _, record in self._closed), *present]

    def training_runs(self) -> tuple[Run, ...]:
        """Return the stream's runs kept, as received, as training runs of a trial."""
        raw_records = (*(raw for raw, _ in self._closed), *self._present_record())
        return tuple(stream_run(self._trial, raw) for raw in raw_records)

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

    def _canonical_record(self, raw_record: Record) -> Record:
        record = load_run(stream_run(self._trial, raw_record), self._trial.reference_point).record
        rate = self._trial.estimate.rate
        return record if rate is None else record.resampled(rate)


# One estimator fed sample by sample: the criterion of `identify` over a growing window, then over carried information.

# samples before the first search: fewer leave more unknowns than a fit of a dozen coefficients and its start can bear
_MIN_SAMPLES = 30
_OFF = 0.001  # standard errors by which a filter's estimate may be off the search's; chosen
_STRAIGHT = 1e-3  # bend below which a model counts as having this one, so that searches go on; chosen
_NOTHING_FREE = "every coefficient of the model is fixed: none is estimated"
_UNWATCHED = "Changes are not watched: the residuals are not white, so that the model or its inputs are off."
_UNEXPLAINED = 20.0  # s of coloured residuals before which a change that explains them is seen; chosen
_SHOWN, _YOUNG = 0.3, 20.0  # relative standard errors below which numbers say something; s of a window; chosen
_UNRELEASED = "the motion does not die out from a release yet, and no initial state explains it: it may still be held"
_MOVING = 60.0  # s of a window, up to which an estimate moves so much within a block that each sample decides; chosen
_NO_MODEL_YET = "the samples so far lead to no model that can be simulated"


class OnlineEstimator:
    """Feed with `update`; the same samples give the same bits. No threads, no files.

    A trial's own training runs come first and stay in the window. Beside it a filter watches for a change of the
    coefficients, behind which the estimate begins anew.

    Raises:
        InputError: the trial has no [follow], or its own records do not pass.
    """

    def __init__(self, trial: Trial) -> None:
        self._trial, self._stream = trial, require_stream(trial)
        is_continued = suits_whole_runs(trial)
        self._schedule = SearchSchedule(CONTINUED_INTERVALS if is_continued else REPEATED_INTERVALS)
        self._search: WindowSearch = ContinuedSearch(trial, self._schedule) if is_continued else RepeatedSearch(trial)
        self._window = StreamWindow(trial)
        self._change_detector = ChangeDetector(trial.model.parameters.free_names)
        self._watch: RecursivePhase | None = None  # for changes, since the first search
        self._between: RecursivePhase | None = None  # since the last search, for what is shown until the next
        self._is_curved = False  # the model, within the standard errors of the last search
        self._coloured_since = np.inf  # s, the first of the searches in a row whose residuals are coloured
        self._phase: KeptPhase | RecursivePhase = WarmUp()
        self._progress = StreamProgress()
        self._snapshot = first_snapshot(trial.model)
        if not trial.model.parameters.free_names:
            self._snapshot = replace(self._snapshot, advice=_NOTHING_FREE)

    def begin_run(self) -> None:
        """Begin a new run with the next sample: after a gap, or a jump of the clock.

        Raises:
            InputError: the run that ends cannot be used; the new one has begun nevertheless.
        """
        is_kept = not isinstance(self._phase, RecursivePhase) and self._window.open_samples > 0
        if is_kept and self._schedule.is_due_at_run_end(self._window.seconds):
            self.relinearise()
        if isinstance(self._phase, RecursivePhase):
            self._leave_filter(self._phase)
        if self._watch is not None:
            self._watch.begin_run()
        self._between = None
        self._change_detector.restart()
        if isinstance(self._phase, Window | Carried):  # what the next run is compared with
            self._compare_search(self._phase.estimate)
        self._progress = self._progress.with_run()
        self._window.begin_run(self._progress.runs)

    def update(self, sample: Sample) -> Snapshot:
        """Take in one sample, later than the last, and return the estimate by now."""
        return self.update_block(np.array([sample.time]), sample.values[None])

    def update_block(self, times: Array, values: Array) -> Snapshot:
        """Take in samples of one run, later than the last, and return the estimate by now.

        The estimate has the bits that it has behind the same samples one by one.

        Args:
            times: s on the stream's clock, (n,); values: a row a sample, as the stream's layout has them, (n, columns).
        """
        if not self._window.has_run:
            self.begin_run()
        if not self._trial.model.parameters.free_names:
            self._progress = self._progress.with_samples(times)
        taken, watched, watch = 0, 0, None  # samples taken in, and by which watch ahead of them
        while taken < len(times) and self._trial.model.parameters.free_names:
            if self._watch is not watch or watched <= taken:
                watch = self._watch
                watched = len(times) if watch is None else taken + watch.take(times[taken:], values[taken:])
            until = min(watched, taken + self._samples_to_decision())
            self._take(times[taken:until], values[taken:until], is_watch_ended=until == watched)
            taken = until
        self._show()
        self._snapshot = at_progress(self._snapshot, self._progress)
        return self._snapshot

    def _samples_to_decision(self) -> int:
        """Number of samples up to the next at which it is decided how to go on, at most."""
        if isinstance(self._phase, RecursivePhase):
            return self._phase.room
        return 1 if self._between is None or self._window.seconds < _MOVING else self._between.room

    def _take(self, times: Array, values: Array, *, is_watch_ended: bool) -> None:
        """Take in samples up to the next decision; is_watch_ended: whether the watch may end with the last of them."""
        self._progress = self._progress.with_samples(times)
        phase = self._phase
        if isinstance(phase, RecursivePhase):
            phase.take(times, values)
            if phase.room == BLOCK_SAMPLES and not phase.is_sound:
                self._leave_filter(phase)
            elif is_watch_ended and self._is_changed():
                self._begin_anew()
            return
        self._window.add(times, values)
        if self._between is not None:
            self._between.take(times, values)
            if self._between.room == BLOCK_SAMPLES and not self._between.is_sound:
                self._between = None
                assert not isinstance(phase, WarmUp)
                self._snapshot = window_snapshot(self._snapshot, self._trial.model, phase, phase.estimate)
        if is_watch_ended and self._is_changed():
            self._begin_anew()
        elif self._is_search_due() and self._window.open_samples >= MIN_RUN_SAMPLES:
            self.relinearise()

    def _show(self) -> None:
        """Show the estimate of all samples so far."""
        if isinstance(self._phase, RecursivePhase):
            self._snapshot = recursive_snapshot(self._snapshot, self._trial.model, self._phase)
        elif self._between is not None:
            estimate = self._between.estimate_by_now()
            if estimate is not None:
                self._snapshot = snapshot_of_now(self._snapshot, self._trial.model, estimate)

    def _is_search_due(self) -> bool:
        """Whether the window is to be searched: the filter beside it has moved too far, or where there is none, now."""
        phase = self._phase
        if self._between is None or not isinstance(phase, Window | Carried):
            return self._is_curved or self._window.seconds >= self._schedule.next_search
        if self._between.room < BLOCK_SAMPLES and self._window.seconds >= _MOVING:
            return False
        self._show()
        if is_window_full(phase, self._window.seconds, self._stream, self._schedule.intervals):
            return True
        moved = np.abs(self._snapshot.value - phase.estimate.value)
        off = 0.5 * _OFF if self._window.seconds < _YOUNG else _OFF  # its bend is known less well while it is young
        most = np.sqrt(2.0 * off / max(self._between.bend, _STRAIGHT))
        return bool(np.any(moved > most * self._snapshot.standard_error))

    def relinearise(self) -> Snapshot:
        """Search now over everything in the window; a filter takes in the samples that wait for later ones."""
        if not self._trial.model.parameters.free_names:
            return self._snapshot
        if isinstance(self._phase, RecursivePhase):
            self._phase.finish()
            self._snapshot = recursive_snapshot(self._snapshot, self._trial.model, self._phase)
        else:
            self._search_window(self._phase)
        return self._snapshot

    def raw_runs(self) -> tuple[Run, ...]:
        """Return the stream's runs that are still kept, as training runs of a trial whose files have been read."""
        return self._window.training_runs()

    @property
    def snapshot(self) -> Snapshot:
        """The estimate by now."""
        return self._snapshot

    @property
    def change(self) -> CoefficientChange | None:
        """The last change of the coefficients; None: there was none."""
        return self._change_detector.detected

    @property
    def covariance(self) -> Array:
        """Covariance of the free coefficients, (k, k); infinite diagonal where nothing is known."""
        if isinstance(self._phase, WarmUp):
            return np.diag(np.full(len(self._snapshot.names), np.inf))
        return self._phase.covariance if isinstance(self._phase, RecursivePhase) else self._phase.estimate.covariance

    def records(self) -> tuple[Record, ...]:
        """Return the records in the window, in canonical frames and signs.

        Raises:
            InputError: the present run is too short to be read as a record.
        """
        return tuple(self._window.records())

    def _search_window(self, phase: KeptPhase) -> None:
        """Search over the window, and leave it where it is full."""
        seconds = self._window.seconds
        self._schedule.note_search(seconds, is_carried=isinstance(phase, Carried))
        if self._window.samples >= _MIN_SAMPLES:
            records = list[Record]()
            try:
                records = self._window.records()
                with np.errstate(all="ignore"):  # a trial step may overflow; the search then takes another
                    near = None if self._between is None else self._snapshot.value
                    estimate = self._search.estimate(phase, records, near)
                if self._is_unreleased(records, estimate):
                    self._wait_for_release(records)
                    return
                if self._watch is None and self._compare_search(estimate):
                    self._begin_anew()
                    return
                self._phase = phase = phase.with_estimate(estimate)
                self._snapshot = window_snapshot(self._snapshot, self._trial.model, phase, estimate)
                self._between = self._filter_behind(estimate)
                self._is_curved = self._between is None and self._is_young(estimate)
                if self._watch is None:
                    self._watch = self._filter_behind(estimate, is_watching=True)
                self._note_colour(is_coloured=estimate.is_coloured and self._search.is_efficient)
            except (InputError, np.linalg.LinAlgError) as error:
                if isinstance(phase, WarmUp):
                    reason = str(error) if isinstance(error, InputError) else _NO_MODEL_YET
                    reason = _UNRELEASED if records and self._has_no_release(records[-1]) else reason
                    self._snapshot = replace(self._snapshot, advice=reason)
        if not isinstance(phase, WarmUp) and is_window_full(phase, seconds, self._stream, self._schedule.intervals):
            self._leave_window(phase)

    def _is_unreleased(self, records: list[Record], estimate: WindowEstimate) -> bool:
        """Whether the present run has no release, and no initial state explains it."""
        return self._has_no_release(records[-1]) and (estimate.is_coloured or not is_explained(estimate.estimate))

    def _has_no_release(self, record: Record) -> bool:
        """Whether nothing is recorded that moves the ship, and it does not roll out either."""
        return _is_undriven(self._trial.model, record) and not is_free_decay(record)

    def _wait_for_release(self, records: list[Record]) -> None:
        """Keep the estimate of the runs before the present one; of this one alone there is none."""
        if len(records) == 1 and not isinstance(self._phase, Carried):
            self._phase, self._between, self._watch = WarmUp(), None, None
            self._snapshot = replace(first_snapshot(self._trial.model, self.change), advice=_UNRELEASED)

    def _note_colour(self, *, is_coloured: bool) -> None:
        """Watch no longer, and say so, where residuals stay coloured without a change that would explain it."""
        now = self._progress.last_time
        self._coloured_since = min(self._coloured_since, now) if is_coloured else np.inf
        is_unexplained = now - self._coloured_since >= _UNEXPLAINED
        is_unwatched = is_coloured and (self._watch is None or is_unexplained)
        if is_unexplained:
            self._watch = None
            self._change_detector.doubt(self._coloured_since)
        unwatched = _UNWATCHED if is_unwatched else ""
        self._snapshot = replace(self._snapshot, change=self._change_detector.detected, unwatched=unwatched)

    def _is_young(self, estimate: WindowEstimate) -> bool:
        """Whether numbers can be shown but a model may still be too curved for a filter: every sample is searched."""
        error = np.sqrt(np.diagonal(estimate.covariance))
        is_shown = bool(np.all(error < _SHOWN * np.abs(estimate.value)))
        return is_shown and self._search.is_efficient and self._window.seconds < _YOUNG

    def _filter_behind(self, estimate: WindowEstimate, *, is_watching: bool = False) -> RecursivePhase | None:
        """A filter behind a search, where one can take over."""
        if not self._search.is_efficient or estimate.is_coloured:
            return None
        at = self._trial.reference_point
        return filter_phase(estimate, self._stream, at, self._between, is_watching=is_watching)

    def _leave_window(self, phase: Window | Carried) -> None:
        """Go on with a filter where one can take over, else with the window's information."""
        following = None
        if self._search.is_efficient:
            following = filter_phase(phase.estimate, self._stream, self._trial.reference_point)
        if following is None:
            is_efficient = self._search.is_efficient
            following = carried_phase(phase, self._window.seconds, self._stream, is_efficient=is_efficient)
            self._schedule.note_search(0.0, is_carried=True)
        self._between = None
        self._change_detector.restart()
        self._phase = following
        self._window.clear()

    def _leave_filter(self, phase: RecursivePhase) -> None:
        """Go on with a window: with the filter's information, or from nowhere where it has diverged."""
        self._phase = phase.to_window()
        self._schedule.restart()
        if isinstance(self._phase, Carried):
            self._snapshot = recursive_snapshot(self._snapshot, self._trial.model, phase)
        else:
            self._snapshot = first_snapshot(self._trial.model, self.change)
            self._watch = None
            self._change_detector.restart()

    def _begin_anew(self) -> None:
        """Forget all that was before a change: what follows comes from later samples alone."""
        self._phase, self._watch, self._between = WarmUp(), None, None
        self._coloured_since, self._is_curved = np.inf, False
        self._window.clear()
        self._schedule.restart()
        self._snapshot = first_snapshot(self._trial.model, self._change_detector.detected)

    def _is_changed(self) -> bool:
        """Whether the filter that watches shows a change with the latest sample."""
        if self._watch is None or not self._watch.watch.is_ended:
            return False
        if self._watch.is_sound:
            return self._change_detector.update(self._progress.last_time, self._watch.watch)
        self._watch = None  # the next search is compared with earlier ones
        return False

    def _compare_search(self, estimate: WindowEstimate) -> bool:
        """Compare a search with earlier ones where successive ones are nested; return whether it shows a change.

        They are not while old samples are forgotten, where every search chooses its criterion anew, and where the
        forces of the same waves change as more of their elevation is known.
        """
        is_nested = self._search.is_efficient and self._stream.waves is None and self._stream.forgetting_time_s is None
        now = GaussianEstimate(estimate.value, estimate.noise_excess * estimate.covariance)
        return is_nested and self._change_detector.update_search(
            self._progress.last_time, now, is_kept=not estimate.is_coloured
        )
