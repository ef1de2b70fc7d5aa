"""The batch criterion over everything seen, started where the last search ended; and its hand-over to a filter."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.estimate.online.recursive import (
    NO_JUMP,
    DivergenceGuard,
    Forgetting,
    GaussianState,
    JumpSearch,
    RecursiveFilter,
)
from seatrial.estimation.estimate.point_estimate import PointEstimate, residual_correlation, residual_spread
from seatrial.estimation.estimate.settings import WHITE_INFLATION, resolved_time, weak_form_half_width
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.information.whiteness import whiteness_p
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations, levenberg_marquardt
from seatrial.physics.simulate.batch import SegmentBatch, batch_class

# Rows of a run that grows.

_INITIAL_CAPACITY = 256  # rows; chosen


class SampleRows:
    """Times and values of one run, (n,) and (n, k), with room that doubles."""

    def __init__(self, width: int) -> None:
        self._time, self._values, self._count = np.empty(_INITIAL_CAPACITY), np.empty((_INITIAL_CAPACITY, width)), 0

    def __len__(self) -> int:
        return self._count

    def add(self, times: Array, values: Array) -> None:
        """Rows more: times (n,), values (n, width)."""
        count = self._count + len(times)
        if count > len(self._time):
            more = max(self._count, len(times))
            self._time = np.concatenate([self._time, np.empty(more)])
            self._values = np.concatenate([self._values, np.empty((more, self._values.shape[1]))])
        self._time[self._count : count], self._values[self._count : count] = times, values
        self._count = count

    @property
    def time(self) -> Array:
        """s, a copy."""
        return self._time[: self._count].copy()

    @property
    def values(self) -> Array:
        """A copy."""
        return self._values[: self._count].copy()

    @property
    def duration(self) -> float:
        """From the first row to the last."""
        return float(self._time[self._count - 1] - self._time[0]) if self._count else 0.0


# Whether a fit is good enough for a filter to take over: how far its model bends within one standard error.

LINEAR_ENOUGH = 0.15
"""Below it a filter ended within 0.15 standard errors of the batch in all of 90 streams of heave and pitch, handed over
after 10 to 60 s; at 0.8 it was off by up to one, at 1.6 by up to three (waterjet zigzags)."""


def curvature(problem: OutputError, common_parameters: Array, initial_states: Array, normal: NormalEquations) -> float:
    """Return the largest curvature over the principal axes: second difference of outputs, one standard error each way.

    In units of what the same step changes to first order, which is one standard deviation of noise; infinite where the
    coefficients are not all identifiable or a ship within their errors blows up. Initial states go along with the
    coefficients. Costs two simulations for each unknown.
    """
    information = normal.without_local()[1]
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-300))  # above zero, for a division
    scaled = information / np.outer(scale, scale)
    if not np.all(np.isfinite(scaled)):
        return np.inf
    values, vectors = np.linalg.eigh(scaled)
    if values[0] < 1e-13:  # rounding of a singular matrix; chosen
        return np.inf
    axes = (vectors / np.sqrt(values)).T / scale
    follow = -np.linalg.pinv(normal.local_hessian, hermitian=True) @ np.swapaxes(normal.cross, 1, 2)
    weight = np.where(np.isfinite(problem.data.measured), 1.0 / problem.noise, 0.0)
    if problem.inflation is not None:
        weight = weight / np.sqrt(problem.inflation)
    here = problem.simulated_outputs(common_parameters, initial_states)
    largest = 0.0
    for axis in axes:
        step = follow @ axis
        with np.errstate(over="ignore", invalid="ignore"):
            both = problem.simulated_outputs(
                common_parameters + axis, initial_states + step
            ) + problem.simulated_outputs(common_parameters - axis, initial_states - step)
            bend = float(np.linalg.norm(weight * (0.5 * both - here)))
        if not np.isfinite(bend):
            return np.inf
        largest = max(largest, bend)
    return largest


# From a fit to a filter: what an output-error fit knows at its last sample, and the filter that goes on from there.


def last_run(
    problem: OutputError, common_parameters: Array, initial_states: Array
) -> tuple[SegmentBatch, Array, Array]:
    """Return a fit's last run with all states as outputs: (rows, nx), and their slopes, (rows, nx, unknowns)."""
    model, data = problem.model, problem.data
    first, last = data.offsets[-2:]
    start, values, corrections = problem.unpack(common_parameters, initial_states)
    batch = batch_class(model)(
        model, np.ascontiguousarray(data.inputs[first:last]), np.array([0, last - first]), data.dt, model.states,
        problem.free, tuple(n.correction for n in problem.nuisances), problem.starts, problem.substeps,
    )  # fmt: skip
    states, slopes, _ = batch.differentiate(0, 1, start[-1:], values[-1:], corrections[-1:])
    return batch, states, slopes


def gaussian_state_from_fit(
    problem: OutputError, common_parameters: Array, initial_states: Array, normal: NormalEquations
) -> GaussianState:
    """Return the state of an output-error fit at the last sample; `normal` are its normal equations at the optimum.

    Corrections of inputs and a current count as the fit left them; their uncertainty is in the coefficients'.

    Raises:
        InputError: the records do not identify every coefficient.
    """
    k = len(problem.free)
    information = normal.without_local()[1]
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-300))  # above zero, for a division
    scaled = information / np.outer(scale, scale)
    # rounding of a singular matrix; chosen
    if not np.all(np.isfinite(scaled)) or np.linalg.eigvalsh(scaled)[0] < 1e-13:
        raise InputError("the records so far do not identify every coefficient; keep the window until they do")
    covariance = (np.linalg.inv(scaled) / np.outer(scale, scale))[:k, :k]
    batch, y, slopes = last_run(problem, common_parameters, initial_states)
    by_start = slopes[-1, :, len(batch.parameters) + len(batch.corrections) :]
    of_start = np.linalg.pinv(normal.local_hessian[-1], hermitian=True)
    moved = -of_start @ normal.cross[-1, :k].T
    spread = by_start @ of_start @ by_start.T
    return GaussianState(
        common_parameters[:k].copy(),
        0.5 * (covariance + covariance.T),
        y[-1],
        slopes[-1, :, :k] + by_start @ moved,
        0.5 * (spread + spread.T),
    )


def filter_from_fit(
    problem: OutputError,
    common_parameters: Array,
    initial_states: Array,
    normal: NormalEquations,
    *,
    forgetting: Forgetting | None = None,
    guard: DivergenceGuard | None = None,
    noise_excess: float = 1.0,
    jumps: JumpSearch = NO_JUMP,
) -> RecursiveFilter:
    """Return the filter that continues after the fit's last sample; `normal` as for `gaussian_state_from_fit`.

    Its noise is the fit's, coloured channels counted as the fit counts them, of `noise_excess` times the variance; an
    innovation is cut where the fit's loss is (`DivergenceGuard` where that is square). See `curvature` for whether the
    fit is good enough, and `JumpSearch` for the `jumps`.

    Raises:
        InputError: the records do not identify every coefficient, or the fit corrects inputs or has a current, which a
            filter does not carry on.
    """
    if problem.unknowns_per_session:
        names = [n for n, _ in problem.session_parameters] + [n.correction.name for n in problem.nuisances]
        raise InputError(f"a filter cannot go on with {', '.join(names)} estimated for each run; keep the window")
    colour = np.ones(len(problem.noise)) if problem.inflation is None else problem.inflation
    guard = guard or DivergenceGuard()
    if np.isfinite(problem.huber):
        guard = replace(guard, huber_limit=problem.huber)
    first, last = problem.data.offsets[-2:]
    known = gaussian_state_from_fit(problem, common_parameters, initial_states, normal)
    return RecursiveFilter(
        problem.model,
        problem.free,
        problem.data.outputs,
        problem.noise * np.sqrt(noise_excess * colour),
        problem.data.dt,
        replace(
            known,
            covariance=noise_excess * known.covariance,
            state_covariance=noise_excess * known.state_covariance,
        ),
        recent_inputs=problem.data.inputs[first:last],
        substeps=problem.substeps,
        forgetting=forgetting,
        guard=guard,
        jumps=jumps,
    )


# The batch criterion over everything seen, started where the last search ended: output error over whole runs.

# predicted decrease of half the sum of squares: some thousandths of a standard error
_NEGLIGIBLE = 1e-5
# of the residuals, from a cold start and from the last estimate; chosen
_FIRST_EVALUATIONS, _LATER_EVALUATIONS = 40, 12
_WHITENESS_LEVEL = 0.01  # significance of the whiteness test; chosen
_CLEAR_EXCESS = 1.3  # of a variance: two standard deviations of that of a hundred samples, where a watch begins; chosen
_TIE_TOLERANCE = 1e-3  # relative difference of misfits that counts as equal; chosen


@dataclass(frozen=True, eq=False)
class WindowEstimate:
    """An estimate from everything in the window.

    Attributes:
        estimate: problem and optimum.
        residuals: its residuals, simulated minus measured, (rows, ny), SI.
        covariance: of the free coefficients, (k, k); infinite diagonal where singular.
        inflation: of each channel's residuals, (ny,); one where they are white.
        record_starts: name and first time of each record.
    """

    estimate: PointEstimate
    residuals: Array
    covariance: Array
    inflation: Array
    record_starts: tuple[tuple[str, float], ...] = ()

    @property
    def value(self) -> Array:
        """The free coefficients, (k,)."""
        return self.estimate.common_parameters[: len(self.estimate.problem.free)]

    @property
    def misfit(self) -> float:
        """Rms residual over the spread of what was measured."""
        spread = np.nanstd(self.estimate.problem.data.measured, axis=0)
        # where a channel never moves; chosen
        return float(np.sqrt(np.nanmean((self.residuals / np.maximum(spread, 1e-12)) ** 2)))

    @property
    def noise_excess(self) -> float:
        """Variance of the residuals over that of the noise as declared, of the channel where it is largest; 1 if near.

        A change of a ship is judged by how clear the data are, not by how clear they are said to be.
        """
        excess = float(np.max(np.nanmean((self.residuals / self.estimate.problem.noise) ** 2, axis=0)))
        return excess if excess > _CLEAR_EXCESS else 1.0

    @property
    def is_coloured(self) -> bool:
        """Whether residuals are correlated in time."""
        return bool(np.any(self.inflation > WHITE_INFLATION))


def cold_start(model: Model, runs: Runs, settings: EstimateSettings) -> WindowEstimate:
    """A search from nowhere as `identify` makes it, and one from the model's own values: the one that leaves less.

    Raises:
        InputError: the records cannot be fitted at all.
    """
    problem = output_error_problem(model, runs, np.inf, settings)
    unit = resolved_time(model, runs.records, runs.length, settings.segment_s)
    first = find_start(problem, runs.records, weak_form_half_width(model, runs.records, unit))
    own = first.problem.start(), first.problem.measured_initial_states()
    known = better_estimate(
        *(
            _search(first.problem, *at, runs, _FIRST_EVALUATIONS)
            for at in ((first.common_parameters, first.initial_states), own)
        )
    )
    again = _search(
        _reweighted_problem(known),
        known.estimate.common_parameters,
        known.estimate.optimum.local,
        runs,
        _FIRST_EVALUATIONS,
    )
    return replace(again, record_starts=_record_starts(runs.records))


def warm_start(
    previous: WindowEstimate, model: Model, runs: Runs, settings: EstimateSettings, near: Array | None = None
) -> WindowEstimate:
    """The search continued on longer records, weights as the last residuals have them.

    near: coefficients (k,) closer to the optimum than the previous ones, as a filter has them by now.

    Raises:
        InputError: the records cannot be fitted at all.
    """
    last = _reweighted_problem(previous)
    problem = replace(
        output_error_problem(model, runs, np.inf, settings),
        noise=last.noise,
        inflation=last.inflation,
        substeps=last.substeps,
    )
    shared = problem.start()
    shared[: len(problem.free)] = previous.value if near is None else near
    local = problem.measured_initial_states()
    begins = _record_starts(runs.records)
    for row, (now, was) in enumerate(zip(begins, previous.record_starts, strict=False)):
        if now == was:
            local[row] = previous.estimate.optimum.local[row]
    return replace(_search(problem, shared, local, runs, _LATER_EVALUATIONS), record_starts=begins)


def refuse_diverging(estimate: PointEstimate, runs: Runs, settings: EstimateSettings) -> None:
    """Refuse an estimate over segments at which whole runs diverge, as `identify` does.

    Raises:
        InputError: they do.
    """
    problem = output_error_problem(estimate.problem.model, runs, np.inf, settings)
    problem = replace(problem, nuisances=estimate.problem.nuisances, substeps=estimate.problem.substeps)
    with np.errstate(all="ignore"):
        simulated = problem.simulated_outputs(estimate.common_parameters, problem.measured_initial_states())
    if not np.all(np.isfinite(simulated)):
        raise InputError("the record so far gives no model that can be simulated; continue, or give larger orders")


def better_estimate(one: WindowEstimate, other: WindowEstimate) -> WindowEstimate:
    """Return the estimate of smaller misfit, both on the same records; one that is not finite counts as infinite."""
    left = [known.misfit if np.isfinite(known.misfit) else np.inf for known in (one, other)]
    return other if left[1] < (1.0 - _TIE_TOLERANCE) * left[0] else one


def _record_starts(records: Sequence[Record]) -> tuple[tuple[str, float], ...]:
    return tuple((record.name, float(record.time[0])) for record in records)


def _search(
    problem: OutputError, common_parameters: Array, initial_states: Array, runs: Runs, evaluations: int
) -> WindowEstimate:
    given = np.array([runs.noise.get(o, np.nan) for o in problem.data.outputs])
    problem = replace(problem, noise=np.where(np.isfinite(given), given, problem.noise))
    found = levenberg_marquardt(
        problem, common_parameters, initial_states, negligible=_NEGLIGIBLE, evaluations=evaluations
    )
    made = PointEstimate(problem, found)
    left = made.residuals()
    inflation = _inflation(problem, left)
    count = len(problem.free)
    hessian = found.normal.without_local()[1]
    covariance = inverse(hessian)[:count, :count] if np.all(np.isfinite(hessian)) else np.diag(np.full(count, np.inf))
    trust = 1.0 if problem.inflation is not None else float(np.max(inflation))
    return WindowEstimate(made, left, covariance * max(trust, 1.0), inflation)


def _inflation(problem: OutputError, residuals: Array) -> Array:
    """Variance inflation of each channel's residuals; one where a short record does not distinguish them from white."""
    rho, inflation = residual_correlation(problem, residuals)
    samples = np.isfinite(residuals).sum(axis=0)
    p = np.array([whiteness_p(r, int(n)) for r, n in zip(rho, samples, strict=True)])
    return np.where(p < _WHITENESS_LEVEL, inflation, 1.0)


def _reweighted_problem(estimate: WindowEstimate) -> OutputError:
    """The problem with noise and effective numbers of samples from the residuals it left."""
    problem = estimate.estimate.problem
    inflation = (
        np.where(estimate.inflation > WHITE_INFLATION, estimate.inflation, 1.0) if estimate.is_coloured else None
    )
    return replace(problem, noise=residual_spread(problem, estimate.residuals), inflation=inflation)
