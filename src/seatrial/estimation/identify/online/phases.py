"""Phases of an online estimate: samples that are kept, information that is carried on, and what is shown of both."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.results.online import CoefficientChange, EstimatorPhase, Snapshot
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.conventions import canonical_record
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import FitCriterion, Trial, with_input_corners
from seatrial.data.trial.settings import Stream
from seatrial.estimation.estimate.assemble import MarginalPrior, Runs, marginalise
from seatrial.estimation.estimate.fit import estimate_model, with_segment_seconds
from seatrial.estimation.estimate.online.change_detector import FilterWatch, GaussianEstimate, jump_search
from seatrial.estimation.estimate.online.recursive import Forgetting
from seatrial.estimation.estimate.online.window import (
    LINEAR_ENOUGH,
    WindowEstimate,
    better_estimate,
    cold_start,
    curvature,
    filter_from_fit,
    last_run,
    refuse_diverging,
    warm_start,
)
from seatrial.estimation.information.covariance import inverse
from seatrial.physics.simulate.replay import inputs_of

# What an online estimate rests on while samples are kept, and what the samples of a full window become.


@dataclass(frozen=True)
class WarmUp:
    """No estimate yet: too few samples, or none that the model can be fitted to."""

    def with_estimate(self, estimate: WindowEstimate) -> "Window":
        """Return the phase that the first estimate begins."""
        return Window(estimate)


@dataclass(frozen=True, eq=False)
class Window:
    """An estimate from every sample received so far, all of them kept."""

    estimate: WindowEstimate

    def with_estimate(self, estimate: WindowEstimate) -> Self:
        """Return the same phase with a later estimate."""
        return replace(self, estimate=estimate)

    def carried(self) -> "Carried":
        """Return the phase that keeps the window's normal equations instead of its samples."""
        prior = _window_information(self.estimate)
        hessian = self.estimate.estimate.optimum.normal.without_local()[1]
        return Carried(self.estimate, prior, prior.inflation(hessian, self.estimate.covariance))


@dataclass(frozen=True, eq=False)
class Carried:
    """An estimate from the samples kept and from the information of those no longer kept.

    Attributes:
        estimate: the latest, from both.
        prior: information of the samples no longer kept.
        inflation: factor on the covariance of that information for correlated residuals, at least 1.
    """

    estimate: WindowEstimate
    prior: MarginalPrior
    inflation: float = 1.0

    def with_estimate(self, estimate: WindowEstimate) -> Self:
        """Return the same phase with a later estimate."""
        return replace(self, estimate=estimate)

    def carried(self) -> Self:
        """Return the phase whose information includes the samples kept."""
        return replace(self, prior=_window_information(self.estimate))

    def discounted(self, share: float) -> Self:
        """Return the phase with that share of its information, 0 to 1."""
        return replace(self, prior=self.prior.discounted(share))

    def inflated_covariance(self, hessian: Array, prior_weight: Array) -> Array:
        """Return the covariance of the common parameters, (n, n), with correlated residuals allowed for.

        Args:
            hessian: of the search at its optimum, (n, n), priors and this phase's information included.
            prior_weight: inverse variances of the parameters' priors, (n,), which are not inflated.
        """
        stated = np.diag(prior_weight)
        return inverse((hessian - stated) / self.inflation + stated)


KeptPhase = WarmUp | Window | Carried
"""The phases that keep samples; the recursive filter keeps none."""


def _window_information(estimate: WindowEstimate) -> MarginalPrior:
    """What the estimate's problem knows of the coefficients, earlier information included, priors taken out."""
    problem = estimate.estimate.problem
    indices = np.array([problem.model.parameters.index(n) for n in problem.free], dtype=np.int64)
    mean, weight = (values[: len(indices)] for values in problem.priors)
    hessian = estimate.estimate.optimum.normal.without_local()[1]
    return marginalise(indices, estimate.value, hessian, mean, weight)


# When the window is searched and left, in seconds of samples that it holds.

# s without a search that make one worthwhile when a run ends, and the share of the window that must be new by then
_RUN_END_SECONDS, _RUN_END_NEW_SHARE = 10.0, 0.1
# s between searches from nowhere that check one from the last optimum: at least, and as a share of the window
_COLD_CHECK_SECONDS, _COLD_CHECK_SHARE = 10.0, 0.5
# s of samples after which carried information is renewed, at least: several periods of any motion of a ship
_STRETCH_SECONDS = 60.0


@dataclass(frozen=True)
class SearchIntervals:
    """How often one way of searching is used; a search must cost less than the samples between two take to come.

    Attributes:
        shortest: s between two searches, at least.
        share: between two, as a share of what the window has beyond `excess_from` s.
        stretch_share: of a full window, after which carried information is renewed.
        carried: s between two where information is carried; None: as for a window.
    """

    shortest: float
    share: float
    excess_from: float = 0.0
    stretch_share: float = 0.0
    carried: float | None = None

    def interval(self, seconds: float, *, is_carried: bool) -> float:
        """Return the s until the next search, with `seconds` s of samples in the window."""
        if is_carried and self.carried is not None:
            return self.carried
        return max(self.shortest, self.share * (seconds - self.excess_from))

    def stretch(self, window: float) -> float:
        """Return the s of samples after which carried information is renewed; window: s, a full one."""
        return max(_STRETCH_SECONDS, self.stretch_share * window)


CONTINUED_INTERVALS = SearchIntervals(2.5, 0.15, excess_from=60.0, carried=_STRETCH_SECONDS)
"""From the last optimum, tens of milliseconds each: every 2.5 s over the first 77 s, then 15 % of the rest."""
REPEATED_INTERVALS = SearchIntervals(10.0, 0.25, stretch_share=0.25)
"""From nowhere, seconds each: every 10 s over the first 40 s, then a quarter of the window."""


@dataclass
class SearchSchedule:
    """Times of searches, s of samples in the window.

    Attributes:
        next_search: from which on the next one is made.
        last_search: when the last one was made.
        next_cold_start: from which on a search from nowhere may check one from the last optimum.
    """

    intervals: SearchIntervals
    next_search: float = 0.0
    last_search: float = 0.0
    next_cold_start: float = 0.0

    def note_search(self, seconds: float, *, is_carried: bool) -> None:
        """Set the next search after one made now, with `seconds` s of samples in the window."""
        self.next_search = seconds + self.intervals.interval(seconds, is_carried=is_carried)
        self.last_search = seconds

    def note_cold_start(self) -> None:
        """Set the next check from nowhere after one made with the last search."""
        self.next_cold_start = self.last_search + max(_COLD_CHECK_SECONDS, _COLD_CHECK_SHARE * self.last_search)

    def is_due_at_run_end(self, seconds: float) -> bool:
        """Return whether enough is new for a search as a run ends with `seconds` s of samples in the window."""
        return seconds - self.last_search >= max(_RUN_END_SECONDS, _RUN_END_NEW_SHARE * seconds)

    def restart(self) -> None:
        """Begin with an empty window."""
        self.next_search = self.last_search = self.next_cold_start = 0.0


# How the window's estimate is found: by continued output error over whole runs, or by `identify` anew each time.

# s of samples within which a search from nowhere accompanies the one from the last optimum, which may be a local one;
# later where residuals are correlated, or where their rms over that of the last estimate exceeds this ratio
_FIRST_SECONDS, _MISFIT_GROWTH = 60.0, 1.2


class WindowSearch(Protocol):
    """One way to find the estimate of what is kept."""

    @property
    def is_efficient(self) -> bool:
        """Whether all estimates minimise one criterion over whole runs.

        Only then can a filter take over, and successive estimates be tested for a change.
        """
        ...

    def estimate(self, phase: KeptPhase, records: Sequence[Record], near: Array | None = None) -> WindowEstimate:
        """Return the estimate from the records and from what the phase carries; near: coefficients (k,) close to it.

        Raises:
            InputError: the records cannot be fitted.
        """
        ...


@dataclass(frozen=True, eq=False)
class ContinuedSearch:
    """Output error over whole runs, from the last optimum; `schedule` says when to check it by one from nowhere.

    When inputs took effect counts as known, unless the trial names their delays.
    """

    trial: Trial
    schedule: SearchSchedule
    is_efficient: bool = True

    def estimate(self, phase: KeptPhase, records: Sequence[Record], near: Array | None = None) -> WindowEstimate:
        """As `WindowSearch.estimate`."""
        model, runs = self.trial.model, _runs(self.trial, phase, records)
        # a delay that is estimated has no place in the filter that takes over between searches
        known = self.trial.estimate.with_known_timing(model.input_names)
        settings = with_segment_seconds(known, model, runs)
        warm = None
        if not isinstance(phase, WarmUp):
            warm = warm_start(phase.estimate, model, runs, settings, near)
            if isinstance(phase, Carried) or not self._needs_cold_check(warm, phase.estimate):
                return warm
        self.schedule.note_cold_start()
        cold = cold_start(model, runs, settings)
        return cold if warm is None else better_estimate(warm, cold)

    def _needs_cold_check(self, warm: WindowEstimate, previous: WindowEstimate) -> bool:
        """Whether the optimum found from the last one may be a local one, and the last check was long enough ago."""
        seconds = self.schedule.last_search
        is_doubtful = seconds < _FIRST_SECONDS or warm.is_coloured or warm.misfit > _MISFIT_GROWTH * previous.misfit
        return is_doubtful and seconds >= self.schedule.next_cold_start


@dataclass(frozen=True, eq=False)
class RepeatedSearch:
    """The fit that `identify` makes, from nowhere each time."""

    trial: Trial
    is_efficient: bool = False

    def estimate(  # every search begins from nowhere
        self,
        phase: KeptPhase,
        records: Sequence[Record],
        near: Array | None = None,  # noqa: ARG002
    ) -> WindowEstimate:
        """As `WindowSearch.estimate`; also refuses an estimate at which whole runs diverge."""
        model, runs = self.trial.model, _runs(self.trial, phase, records)
        settings = with_segment_seconds(self.trial.estimate, model, runs)
        if isinstance(phase, Carried):  # carried information holds about that point
            model = model.with_parameters(model.parameters.with_free_values(phase.estimate.value))
        estimation = estimate_model(model, runs, settings)
        point, covariance = estimation.estimate, estimation.interval.covariance
        refuse_diverging(point, runs, settings)
        if isinstance(phase, Carried):
            covariance = phase.inflated_covariance(point.optimum.normal.without_local()[1], point.problem.priors[1])
        count = len(point.problem.free)
        return WindowEstimate(point, estimation.residuals, covariance[:count, :count], estimation.inflation)


def suits_whole_runs(trial: Trial) -> bool:
    """Return whether the trial's criterion is output error over whole runs, so that a search can be continued."""
    wishes, model = trial.estimate, trial.model
    is_output_error = wishes.criterion in (FitCriterion.AUTO, FitCriterion.OUTPUT_ERROR)
    return is_output_error and wishes.segment_s is None and (model.is_affine or not model.has_course)


def _runs(trial: Trial, phase: KeptPhase, records: Sequence[Record]) -> Runs:
    """The records, each a session, and beside them the trial's static forces or the carried information with them."""
    cornered = [with_input_corners(record, trial.model) for record in records]
    runs = replace(Runs.one_session_each(cornered, trial.ship.length), noise=trial.noise)
    if isinstance(phase, Carried):  # with it go the correlations of priors
        return replace(runs, carried=(phase.prior,))
    return replace(runs, forces=trial.forces, joint_priors=trial.joint_priors)


# Beyond the window: the fit's information carried on by a recursive filter, a block of samples at a time.

# samples taken in at once where a sample needs its neighbours, and samples between two looks for a change: enough to
# spread the cost, few enough that numbers move within a second at 10 Hz
BLOCK_SAMPLES = 10


@dataclass(frozen=True, eq=False)
class SampleMap:
    """A stream's columns to a model's inputs and measured outputs where each sample does so by itself and linearly.

    Attributes:
        matrix: (nu + ny, columns); constant: (nu + ny,); uses: which columns a row needs, (nu + ny, columns).
    """

    matrix: Array
    constant: Array
    uses: NDArray[np.bool_]

    @classmethod
    def of_stream(cls, convert: Callable[[Array], Array], columns: int) -> "SampleMap | None":
        """Return the map of a conversion (n, columns) -> (n, nu + ny) of rows; None where it is not linear, row by row.

        The conversion is that of the files' readers; it is tried on units and on random rows.
        """
        rng = np.random.default_rng(0)
        units = convert(np.concatenate([np.zeros((1, columns)), np.eye(columns)]))
        constant, matrix = units[0], (units[1:] - units[0]).T
        rows = rng.uniform(-1.0, 1.0, (BLOCK_SAMPLES, columns))
        is_linear = np.allclose(convert(rows), rows @ matrix.T + constant, rtol=_EXACT, atol=_EXACT, equal_nan=True)
        return cls(np.nan_to_num(matrix), constant, np.nan_to_num(matrix) != 0.0) if is_linear else None

    def apply(self, values: Array) -> Array:
        """Return inputs and outputs of samples (n, columns), NaN where a value that they need is missing.

        Column by column, so that a sample has the same bits however many come with it.
        """
        missing = np.isnan(values)
        is_whole = not missing.any()
        known = values if is_whole else np.where(missing, 0.0, values)
        mapped = np.repeat(self.constant[None], len(values), axis=0)
        for column in range(values.shape[1]):
            mapped += known[:, column : column + 1] * self.matrix[:, column]
        if not is_whole:
            mapped[missing @ self.uses.T] = np.nan
        return mapped


_EXACT = 1e-12  # rounding of a conversion
_ROUGHER = 10.0  # times the motions in a fit's run, with which a new run may begin; chosen: the sea may have grown


class RecursivePhase:
    """Goes on behind the last sample of a fit.

    Attributes:
        bend: of the model within one standard error of the fit, see `curvature`.
        watch: for changes of the coefficients, if this is a filter that watches: it forgets nothing, its noise is that
            of the fit's residuals, and it takes in samples one by one.

    Raises:
        InputError: the fit is too curved or does not identify every coefficient, waves come from an elevation, or
            inputs are corrected for each run; a window goes on instead.
    """

    def __init__(
        self,
        estimate: WindowEstimate,
        stream: Stream,
        reference_point: float,
        before: Self | None = None,
        *,
        is_watching: bool = False,
    ) -> None:
        fit = estimate.estimate
        optimum = (fit.problem, fit.common_parameters, fit.optimum.local, fit.optimum.normal)
        if stream.waves is not None:
            raise InputError("a filter cannot turn an elevation into forces sample by sample")
        # a model bends less within errors that are smaller
        self._error = np.sqrt(np.diag(estimate.covariance))
        shrunk = 1.0 if before is None else float(np.max(self._error / before._error))
        self.bend = curvature(*optimum) if before is None else shrunk * before.bend
        if self.bend > LINEAR_ENOUGH:
            raise InputError("the fit is too curved within its own errors for a filter to take over")
        self._estimate, self._stream, self._reference_point = estimate, stream, reference_point
        widest = tuple(float(v) for v in np.maximum(np.abs(estimate.value), _scales(estimate)))
        forgetting = None if stream.forgetting_time_s is None else Forgetting(stream.forgetting_time_s, widest)
        if is_watching:
            jumps = jump_search(stream.rate)
            self._filter = filter_from_fit(*optimum, noise_excess=estimate.noise_excess, jumps=jumps)
        else:
            self._filter = filter_from_fit(*optimum, forgetting=forgetting)
        self.watch = FilterWatch(self._filter)
        self._model, self._outputs = fit.problem.model, fit.problem.data.outputs
        columns = len(stream.layout.columns)
        self._last_inputs = np.zeros(len(self._model.inputs))
        # a heading turns on and on, so that a sample of it needs those before
        self._map = None if self._model.has_heading else SampleMap.of_stream(self._converted, columns)
        self._is_immediate = is_watching and self._map is not None
        width = columns if self._map is None else len(self._map.constant)
        self._times, self._rows = np.empty(0), np.empty((0, width))  # that wait for a block

    def take(self, times: Array, values: Array) -> int:
        """Take in n samples, up to that at which a watch ends, and return how many; times (n,), values (n, columns)."""
        rows, taken = values if self._map is None else self._filled(self._map.apply(values)), 0
        while taken < len(times):
            until = len(times) if self._is_immediate else min(taken + self.room, len(times))
            self._times = np.concatenate([self._times, times[taken:until]])
            self._rows = np.concatenate([self._rows, rows[taken:until]])
            if self._is_immediate or self.room == 0:
                used = self._process_block()
                if self.watch.is_ended:
                    return min(taken + used, len(times)) if self._is_immediate else until
            taken = until
        return taken

    @property
    def room(self) -> int:
        """Number of samples up to the end of the block that is processed next."""
        return BLOCK_SAMPLES - len(self._times)

    def finish(self) -> None:
        """Take in the samples that wait: the run or the stream ends."""
        if len(self._times) > (self._map is None):
            self._process_block()
        self._filter.flush()

    def begin_run(self) -> None:
        """A new run starts with the next sample, in a state that the run of the fit says little of."""
        self.finish()
        fit = self._estimate.estimate
        states = last_run(fit.problem, fit.common_parameters, fit.optimum.local)[1]
        self._filter.begin_run(np.mean(states, axis=0), _ROUGHER**2 * np.cov(states, rowvar=False))

    def to_window(self) -> Carried | WarmUp:
        """Finish, and return the phase that goes on with a run whose initial state is unknown."""
        self.finish()
        if not self.is_sound:
            return WarmUp()
        problem = self._estimate.estimate.problem
        indices = np.array([self._model.parameters.index(n) for n in problem.free], dtype=np.int64)
        mean, weight = (values[: len(indices)] for values in problem.priors)
        return Carried(self._estimate, marginalise(indices, self.value, inverse(self.covariance), mean, weight))

    @property
    def is_sound(self) -> bool:
        """Whether the filter's numbers are to be trusted."""
        return self._filter.is_sound

    @property
    def value(self) -> Array:
        """Coefficients, (k,)."""
        return self._filter.value

    @property
    def covariance(self) -> Array:
        """Of the coefficients, (k, k)."""
        return self._filter.covariance

    def estimate_by_now(self) -> GaussianEstimate | None:
        """Return the estimate with the samples that still wait, as if none came; None where they wait for a block."""
        if self._map is None:
            return None
        return GaussianEstimate(*self._filter.estimate_with(*self._split(self._rows)))

    @property
    def noise(self) -> dict[str, float]:
        """Rms of the innovations over the last half minute, SI, by channel."""
        return dict(zip(self._outputs, self._filter.innovations.rms.tolist(), strict=True))

    def _process_block(self) -> int:
        times, rows = self._times, self._rows
        self._times, self._rows = times[:0], rows[:0]
        if self._map is None:
            rows = self._filled(self._converted(rows, times))
        return self.watch.update(times, *self._split(rows))

    def _split(self, rows: Array) -> tuple[Array, Array]:
        """Outputs and inputs of rows (n, nu + ny)."""
        count = len(self._last_inputs)
        return rows[:, count:], rows[:, :count]

    def _filled(self, rows: Array) -> Array:
        """Inputs and outputs of samples, a missing input being the last one received, at first zero."""
        inputs = rows[:, : len(self._last_inputs)]
        if np.isnan(inputs).any():
            for row in inputs:
                missing = np.isnan(row)
                row[missing] = self._last_inputs[missing]
                self._last_inputs = row
        self._last_inputs = inputs[-1].copy()
        return rows

    def _converted(self, values: Array, time: Array | None = None) -> Array:
        """Inputs and outputs of rows (n, columns) as the readers of files have them, (n, nu + ny), NaN if missing."""
        when = np.arange(len(values)) / self._stream.rate if time is None else time
        record = canonical_record(record_from_values("", self._stream.layout, when, values), self._reference_point)
        absent = np.full(len(record), np.nan)
        names = [i.name for i in self._model.inputs]
        whole = {n: record.channel(n).with_values(np.nan_to_num(record[n])) for n in names if n in record}
        complete = Record(record.name, record.time, {**record.channels, **whole}, record.kind, record.provenance)
        inputs = inputs_of(self._model, complete)
        for index, name in enumerate(names):
            if name in record:
                inputs[~np.isfinite(record[name]), index] = np.nan
        outputs = (record[o] if o in record.channels else absent for o in self._outputs)
        return np.column_stack([inputs, *outputs])


def _scales(estimate: WindowEstimate) -> Array:
    """The size of each free coefficient below which a value counts as zero, (k,)."""
    parameters = estimate.estimate.problem.model.parameters
    return np.array([parameters[n].characteristic_scale for n in estimate.estimate.problem.free])


# Where a phase leads: from a full window to a filter, or else to carried information.


def is_window_full(phase: KeptPhase, seconds: float, stream: Stream, intervals: SearchIntervals) -> bool:
    """Return whether a phase with `seconds` s of samples in its window is to be left; never before an estimate."""
    window = min(stream.batch_window_s, stream.forgetting_time_s or np.inf)
    match phase:
        case WarmUp():
            return False
        case Window():
            return seconds >= window
        case Carried():
            return seconds >= min(intervals.stretch(window), window)


def filter_phase(
    estimate: WindowEstimate,
    stream: Stream,
    reference_point: float,
    before: RecursivePhase | None = None,
    *,
    is_watching: bool = False,
) -> RecursivePhase | None:
    """Return the filter that goes on behind the estimate; None where it cannot take over.

    before: the filter behind the last search of the same samples.
    """
    try:
        return RecursivePhase(estimate, stream, reference_point, before, is_watching=is_watching)
    except InputError:
        return None


def carried_phase(phase: Window | Carried, seconds: float, stream: Stream, *, is_efficient: bool) -> Carried:
    """Return the phase that carries the information of a window of `seconds` s.

    Forgetting reduces that information; so do correlated residuals where the search is efficient (the others state
    their covariance with them).
    """
    carried = phase.carried()
    if is_efficient and phase.estimate.estimate.problem.inflation is None:
        carried = carried.discounted(1.0 / max(float(np.max(phase.estimate.inflation)), 1.0))
    if stream.forgetting_time_s is not None:
        carried = carried.discounted(float(np.exp(-seconds / stream.forgetting_time_s)))
    return carried


# What is shown of an online estimate: snapshots of warm-up, window and filter.


@dataclass(frozen=True)
class StreamProgress:
    """What has been received so far: samples, runs, and s of samples, breaks between runs not counted.

    Attributes:
        last_time: s on the stream's clock, of the present run's latest sample; NaN where a run has none yet.
    """

    samples: int = 0
    runs: int = 0
    elapsed: float = 0.0
    last_time: float = np.nan

    def with_run(self) -> "StreamProgress":
        """Return the progress after a run has begun."""
        return replace(self, runs=self.runs + 1, last_time=np.nan)

    def with_samples(self, times: Array) -> "StreamProgress":
        """Return the progress after samples at those times [s]."""
        first = float(times[0]) if np.isnan(self.last_time) else self.last_time
        steps = np.diff(times, prepend=first)
        elapsed = float(np.cumsum(np.concatenate([[self.elapsed], steps]))[-1])  # added up one by one
        return StreamProgress(self.samples + len(times), self.runs, elapsed, float(times[-1]))


def first_snapshot(model: Model, change: CoefficientChange | None = None) -> Snapshot:
    """Return the snapshot before the first sample, or behind a change: start values, infinite standard errors."""
    free = model.parameters.free
    return Snapshot(
        time=0.0,
        samples=0,
        runs=0,
        phase=EstimatorPhase.WAITING,
        names=tuple(p.name for p in free),
        units=tuple(p.unit for p in free),
        value=np.array([p.value for p in free]),
        standard_error=np.full(len(free), np.inf),
        advice="too few samples yet" if free else "",
        change=change,
    )


def window_snapshot(snapshot: Snapshot, model: Model, phase: KeptPhase, estimate: WindowEstimate) -> Snapshot:
    """Return the snapshot with the window's estimate; `phase` says whether earlier information is part of it."""
    outputs = estimate.estimate.problem.data.outputs
    rms = np.sqrt(np.nanmean(estimate.residuals**2, axis=0)).tolist()
    label = EstimatorPhase.RECURSIVE if isinstance(phase, Carried) else EstimatorPhase.WINDOW
    snapshot = replace(snapshot, phase=label, noise=dict(zip(outputs, rms, strict=True)))
    return _with_values(snapshot, model, estimate.value, estimate.covariance)


def recursive_snapshot(snapshot: Snapshot, model: Model, phase: RecursivePhase) -> Snapshot:
    """Return the snapshot with the filter's estimate behind the window."""
    snapshot = replace(snapshot, phase=EstimatorPhase.RECURSIVE, noise=phase.noise)
    return snapshot_of_now(snapshot, model, phase.estimate_by_now() or GaussianEstimate(phase.value, phase.covariance))


def snapshot_of_now(snapshot: Snapshot, model: Model, estimate: GaussianEstimate) -> Snapshot:
    """Return the snapshot with the estimate of all samples so far, between two searches."""
    return _with_values(snapshot, model, estimate.value, estimate.covariance)


def at_progress(snapshot: Snapshot, progress: StreamProgress) -> Snapshot:
    """Return the snapshot at the moment of the latest sample."""
    return replace(snapshot, time=progress.last_time, samples=progress.samples, runs=progress.runs)


@lru_cache(maxsize=4)
def _free_scales(model: Model) -> Array:
    """The scale of each free coefficient, (k,)."""
    return np.array([p.scale for p in model.parameters.free])


def _with_values(snapshot: Snapshot, model: Model, value: Array, covariance: Array) -> Snapshot:
    """A coefficient is identified where its standard error is below its value or its scale."""
    error = np.sqrt(np.maximum(covariance.diagonal(), 0.0))
    is_open = error > np.maximum(np.abs(value), _free_scales(model))
    unidentified = tuple(snapshot.names[k] for k in np.flatnonzero(is_open))
    return replace(snapshot, value=value, standard_error=error, unidentified=unidentified, advice="")
