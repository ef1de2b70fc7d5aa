"""One estimator fed sample by sample: the criterion of `identify` over a growing window, then over what it carries on.

While the window lasts (`Stream.whole`) every re-linearisation goes over all samples, so that the numbers are those of
the batch fit. Beyond it a recursive filter carries the same information on (`Onward`). Where a filter cannot take over
(nuisances, waves from an elevation, segments, a new run) the window's normal equations are kept instead of its samples
(`Carried`), and further stretches are added one by one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.results.online import CoefficientChange, EstimatorPhase, Sample, Snapshot
from seatrial.core.values import Array, InputError, Record
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import FitCriterion, Role, Trial, TrialRun
from seatrial.data.trial.follow_table import require_stream
from seatrial.data.trial.records import load_run
from seatrial.estimation.estimate.fit import estimate_model, with_segment_seconds
from seatrial.estimation.estimate.online.change_detection import ChangeDetector
from seatrial.estimation.estimate.online.marginal_prior import MarginalPrior, marginalise
from seatrial.estimation.estimate.online.sample_rows import SampleRows
from seatrial.estimation.estimate.online.window import (
    WindowEstimate,
    better_estimate,
    cold_start,
    refuse_diverging,
    warm_start,
)
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.time_scale import is_pure_roll
from seatrial.estimation.identify.recursive_phase import CHANGE_TEST_INTERVAL, RecursivePhase
from seatrial.estimation.information.covariance import inverse

# samples before the first search
_MIN_SAMPLES = 30
# s between searches from where the last one ended: at least, and as a share of what the window has beyond the first
_WARM_INTERVAL, _FIRST_SECONDS, _WARM_INTERVAL_SHARE = 2.5, 60.0, 0.15
# s between searches from nowhere: at least, and as a share of the window
_COLD_INTERVAL, _COLD_INTERVAL_SHARE = 10.0, 0.25
# share of the window that is news when a run ends, from which on a search is made then
_NEW_DATA_SHARE = 0.1
_NO_MODEL_YET = "what was seen so far leads to no model that can be simulated"
# started warm, a search from nowhere comes along in the first minute, where residuals are coloured or grow by this
# factor; s between such at least 10, and this share of the window
_MISFIT_GROWTH, _COLD_CHECK_SHARE = 1.2, 0.5
# s of a stretch beyond the window; at least, and as a share of it, where searches are from nowhere
_STRETCH_SECONDS, _COLD_STRETCH_SHARE = 60.0, 0.25


@dataclass
class _WindowData:
    """What the window holds: raw rows of its runs, canonical records of closed ones."""

    rows: list[SampleRows]
    closed_runs: list[Record]


class OnlineEstimator:
    """Feed with `update`; the same samples give the same bits. No threads, no files.

    A trial's own training runs come first and stay in the window.

    Raises:
        InputError: the trial follows nothing, or its own records do not pass.
    """

    def __init__(self, trial: Trial) -> None:
        self._trial, self._stream = trial, require_stream(trial)
        self._trial_records = tuple(
            load_run(run, trial.reference_point).record for run in trial.runs if run.role is Role.TRAIN
        )
        self._window = _WindowData([], [])
        self._run_count = self._sample_count = 0
        self._marginal_prior: MarginalPrior | None = None
        self._inflation = 1.0
        self._estimate: WindowEstimate | None = None
        self._recursive_phase: RecursivePhase | None = None
        self._change_detector = ChangeDetector(trial.model.parameters.free_names, CHANGE_TEST_INTERVAL)
        self._elapsed, self._last_time = 0.0, np.nan
        self._next_search = self._next_cold_start = self._last_search = 0.0
        self._reason = "too few samples yet"
        self._is_warm = self._suits_whole_runs()
        self._snapshot = self._waiting_snapshot()

    def begin_run(self) -> None:
        """What follows belongs to a new run: a gap, or a jump of the clock."""
        if self._recursive_phase is not None:
            self._back_to_window(self._recursive_phase)
        if self._window.rows and len(self._window.rows[-1]):
            if self._window_seconds - self._last_search >= max(_COLD_INTERVAL, _NEW_DATA_SHARE * self._window_seconds):
                self.relinearise()
            self._close_run()
        self._run_count, self._last_time = self._run_count + 1, np.nan
        self._window.rows.append(SampleRows(len(self._stream.layout.columns)))

    def update(self, sample: Sample) -> Snapshot:
        """Take in one sample, later than the last; the estimate by now."""
        if not self._window.rows:
            self.begin_run()
        self._sample_count += 1
        self._elapsed += 0.0 if np.isnan(self._last_time) else sample.time - self._last_time
        self._last_time = sample.time
        if self._recursive_phase is not None:
            self._update_recursive(self._recursive_phase, sample)
            return self._snapshot
        self._window.rows[-1].add(sample.time, sample.values)
        if self._window_seconds >= self._next_search and len(self._window.rows[-1]) >= 3:
            self.relinearise()
        self._snapshot = replace(self._snapshot, time=sample.time, samples=self._sample_count, runs=self._run_count)
        return self._snapshot

    def relinearise(self) -> Snapshot:
        """Search now, from where the last search ended, over everything in the window; a filter takes in what waits."""
        if self._recursive_phase is not None:
            self._recursive_phase.finish()
            self._snapshot = self._recursive_snapshot(self._recursive_phase)
            return self._snapshot
        self._next_search, self._last_search = self._window_seconds + self._search_interval, self._window_seconds
        if sum(len(rows) for rows in self._window.rows) >= _MIN_SAMPLES:
            try:
                with np.errstate(all="ignore"):  # a trial step may overflow; the search then takes another
                    self._estimate = self._search(self._records())
                self._snapshot = self._window_snapshot(self._estimate)
            except (InputError, np.linalg.LinAlgError) as error:
                self._reason = str(error) if isinstance(error, InputError) else _NO_MODEL_YET
                self._snapshot = (
                    replace(self._snapshot, advice=self._reason) if self._estimate is None else self._snapshot
                )
        if self._estimate is not None and self._is_window_full:
            self._hand_over(self._estimate)
        return self._snapshot

    def _hand_over(self, estimate: WindowEstimate) -> None:
        """To the filter where it can take over, else to what is carried."""
        if self._is_warm:
            try:
                self._recursive_phase = RecursivePhase(
                    estimate, self._stream, self._trial.reference_point, self._change_detector
                )
            except InputError:
                self._recursive_phase = None
        if self._recursive_phase is None:
            self._marginalise_window(estimate)
        else:
            if self._stream.forgetting_time is not None and self._marginal_prior is not None:
                self._change_detector.reset()
            self._window, self._trial_records = _WindowData([SampleRows(len(self._stream.layout.columns))], []), ()

    def _update_recursive(self, recursive_phase: RecursivePhase, sample: Sample) -> None:
        if recursive_phase.add(sample.time, sample.values, self._elapsed):
            if not recursive_phase.is_sound:
                self._back_to_window(recursive_phase)
                return
            self._snapshot = self._recursive_snapshot(recursive_phase)
        self._snapshot = replace(self._snapshot, time=sample.time, samples=self._sample_count, runs=self._run_count)

    def _back_to_window(self, recursive_phase: RecursivePhase) -> None:
        """A window goes on: with the filter's information, or from nowhere where the filter lost the ship."""
        recursive_phase.finish()
        self._marginal_prior = recursive_phase.marginal_prior() if recursive_phase.is_sound else None
        self._estimate = self._estimate if recursive_phase.is_sound else None
        self._recursive_phase = None
        if self._estimate is None:
            self._change_detector.restart()
        self._next_search, self._last_search, self._next_cold_start = 0.0, 0.0, 0.0

    def raw_runs(self) -> tuple[TrialRun, ...]:
        """The stream's runs that are still kept, as training runs of a trial whose files have been read."""
        return tuple(
            self._training_run(self._raw_record(rows, i)) for i, rows in self._numbered_runs() if len(rows) > 2
        )

    @property
    def covariance(self) -> Array:
        """Of the free coefficients, (k, k); infinite diagonal where nothing is known."""
        count = len(self._snapshot.names)
        if self._recursive_phase is not None:
            return self._recursive_phase.covariance
        return np.diag(np.full(count, np.inf)) if self._estimate is None else self._estimate.covariance

    def records(self) -> tuple[Record, ...]:
        """What the window holds, in the house's frames and signs.

        Raises:
            InputError: it is too short to be read as a record.
        """
        return tuple(self._records())

    @property
    def _window_seconds(self) -> float:
        """Length of what the window holds."""
        return sum(rows.duration for rows in self._window.rows)

    @property
    def _search_interval(self) -> float:
        """s until the next search."""
        if self._is_warm and self._marginal_prior is not None:
            return _STRETCH_SECONDS
        if self._is_warm:
            return max(_WARM_INTERVAL, _WARM_INTERVAL_SHARE * (self._window_seconds - _FIRST_SECONDS))
        return max(_COLD_INTERVAL, _COLD_INTERVAL_SHARE * self._window_seconds)

    @property
    def _is_window_full(self) -> bool:
        whole = min(self._stream.batch_window, self._stream.forgetting_time or np.inf)
        stretch = _STRETCH_SECONDS if self._is_warm else max(_STRETCH_SECONDS, _COLD_STRETCH_SHARE * whole)
        return self._window_seconds >= (whole if self._marginal_prior is None else min(stretch, whole))

    def _suits_whole_runs(self) -> bool:
        wishes, model = self._trial.estimate, self._trial.model
        is_free = wishes.criterion in (FitCriterion.AUTO, FitCriterion.OUTPUT_ERROR) and wishes.segment_s is None
        return is_free and (model.is_affine or is_pure_roll(model))

    def _numbered_runs(self) -> list[tuple[int, SampleRows]]:
        first = self._run_count - len(self._window.rows) + 1
        return list(enumerate(self._window.rows, start=first))

    def _raw_record(self, rows: SampleRows, number: int) -> Record:
        name = self._stream.name if number <= 1 else f"{self._stream.name}_{number}"
        return record_from_values(name, self._stream.layout, rows.time, rows.values)

    def _training_run(self, raw: Record) -> TrialRun:
        return TrialRun(raw, waves=self._stream.waves)

    def _canonical_record(self, raw: Record) -> Record:
        record = load_run(self._training_run(raw), self._trial.reference_point).record
        rate = self._trial.estimate.rate
        return record if rate is None else record.resampled(rate)

    def _close_run(self) -> None:
        number, rows = self._numbered_runs()[-1]
        if len(rows) < 3:
            self._window.rows.pop()
            return
        self._window.closed_runs.append(self._canonical_record(self._raw_record(rows, number)))

    def _records(self) -> list[Record]:
        open_run = self._numbered_runs()[len(self._window.closed_runs) :]
        return [
            *self._trial_records,
            *self._window.closed_runs,
            *(self._canonical_record(self._raw_record(r, i)) for i, r in open_run if len(r) > 2),
        ]

    def _runs(self, records: Sequence[Record]) -> Runs:
        trial, prior = self._trial, self._marginal_prior
        runs = replace(Runs.one_session_each(records, trial.ship.length), noise=trial.noise)
        return replace(runs, forces=trial.forces) if prior is None else replace(runs, carried=(prior,))

    def _search(self, records: list[Record]) -> WindowEstimate:
        model, runs = self._trial.model, self._runs(records)
        settings = with_segment_seconds(self._trial.estimate, model, runs)
        if not self._is_warm:
            if (
                self._marginal_prior is not None and self._estimate is not None
            ):  # what is carried is known about that point
                model = model.with_parameters(model.parameters.with_free_values(self._estimate.value))
            found = estimate_model(model, runs, settings)
            refuse_diverging(found.estimate, runs, settings)
            covariance = found.interval.covariance
            if self._marginal_prior is not None:
                known = np.diag(found.estimate.problem.priors[1])
                told = found.estimate.optimum.normal.without_local()[1] - known
                covariance = inverse(told / self._inflation + known)
            count = len(found.estimate.problem.free)
            return WindowEstimate(found.estimate, found.residuals, covariance[:count, :count], found.inflation)
        warm = None if self._estimate is None else warm_start(self._estimate, model, runs, settings)
        if warm is not None and self._estimate is not None:
            is_unsure = (
                self._window_seconds < _FIRST_SECONDS
                or warm.is_coloured
                or warm.misfit > _MISFIT_GROWTH * self._estimate.misfit
            )
            if self._marginal_prior is not None or not is_unsure or self._window_seconds < self._next_cold_start:
                return warm
        self._next_cold_start = self._window_seconds + max(_COLD_INTERVAL, _COLD_CHECK_SHARE * self._window_seconds)
        cold = cold_start(model, runs, settings)
        return cold if warm is None else better_estimate(warm, cold)

    def _marginalise_window(self, estimate: WindowEstimate) -> None:
        """Keep the window's normal equations instead of its samples."""
        problem = estimate.estimate.problem
        places = np.array([problem.model.parameters.index(n) for n in problem.free], dtype=np.int64)
        mean, weight = (of[: len(places)] for of in problem.priors)
        hessian = estimate.estimate.optimum.normal.without_local()[1]
        now = marginalise(places, estimate.value, hessian, mean, weight)
        if self._marginal_prior is None:
            self._inflation = now.inflation(hessian, estimate.covariance)
        if self._is_warm and problem.inflation is None:
            now = now.discounted(1.0 / max(float(np.max(estimate.inflation)), 1.0))
        if self._stream.forgetting_time is not None:
            now = now.discounted(float(np.exp(-self._window_seconds / self._stream.forgetting_time)))
        self._marginal_prior, self._trial_records = now, ()
        self._window = _WindowData([SampleRows(len(self._stream.layout.columns))], [])
        self._next_search, self._last_search = self._search_interval, 0.0

    def _waiting_snapshot(self) -> Snapshot:
        free = self._trial.model.parameters.free
        values = np.array([p.value for p in free])
        names, units = tuple(p.name for p in free), tuple(p.unit for p in free)
        return Snapshot(
            0.0, 0, 0, EstimatorPhase.WAITING, names, units, values, np.full(len(free), np.inf), advice=self._reason
        )

    def _window_snapshot(self, estimate: WindowEstimate) -> Snapshot:
        problem = estimate.estimate.problem
        error = _standard_errors(estimate.covariance)
        noise = dict(
            zip(problem.data.outputs, np.sqrt(np.nanmean(estimate.residuals**2, axis=0)).tolist(), strict=True)
        )
        phase = EstimatorPhase.WINDOW if self._marginal_prior is None else EstimatorPhase.RECURSIVE
        return replace(
            self._snapshot, phase=phase, value=estimate.value, standard_error=error, noise=noise,
            unidentified=self._unidentified(estimate.value, error), advice="", change=self._test_for_change(estimate),
        )  # fmt: skip

    def _test_for_change(self, estimate: WindowEstimate) -> CoefficientChange | None:
        """Whether the latest stretch says otherwise, where the estimates are nested.

        They are not while what is old is forgotten, where every search chooses its criterion anew, and where the forces
        of the same waves change as more of their elevation is known.
        """
        is_nested = self._is_warm and self._stream.waves is None and self._stream.forgetting_time is None
        if is_nested and np.all(np.isfinite(estimate.covariance)):
            self._change_detector.update(self._elapsed, estimate.value, estimate.covariance)
        return self._change_detector.detected or self._change_detector.latest

    def _recursive_snapshot(self, recursive_phase: RecursivePhase) -> Snapshot:
        error = _standard_errors(recursive_phase.covariance)
        return replace(
            self._snapshot,
            phase=EstimatorPhase.RECURSIVE,
            value=recursive_phase.value,
            standard_error=error,
            noise=recursive_phase.noise,
            unidentified=self._unidentified(recursive_phase.value, error),
            advice="",
            change=recursive_phase.change,
        )

    def _unidentified(self, value: Array, error: Array) -> tuple[str, ...]:
        free = self._trial.model.parameters.free
        return tuple(p.name for p, v, s in zip(free, value, error, strict=True) if s > max(abs(v), p.scale))


def _standard_errors(covariance: Array) -> Array:
    return np.sqrt(np.maximum(np.diag(covariance), 0.0))
