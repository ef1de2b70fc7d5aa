"""The batch criterion over everything seen, started where the last search ended: output error over whole runs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.point_estimate import PointEstimate, residual_correlation, residual_spread
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.settings import WEAK_FORM_SHIP_LENGTHS, WHITE_INFLATION
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.estimate.time_scale import characteristic_time
from seatrial.estimation.information.autocorrelation import whiteness_p
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import levenberg_marquardt

# predicted decrease of half the sum of squares: some hundredths of a standard error
_NEGLIGIBLE = 1e-3
# of the residuals, from a cold start and from the last estimate; chosen
_FIRST_EVALUATIONS, _LATER_EVALUATIONS = 40, 12
_WHITENESS_LEVEL = 0.01  # significance of the whiteness test; chosen
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
    def is_coloured(self) -> bool:
        """Whether residuals are correlated in time."""
        return bool(np.any(self.inflation > WHITE_INFLATION))


def cold_start(model: Model, runs: Runs, settings: EstimateSettings) -> WindowEstimate:
    """A search from nowhere as `identify` makes it, and one from the model's own values: the one that leaves less.

    Raises:
        InputError: the records cannot be fitted at all.
    """
    problem = output_error_problem(model, runs, np.inf, settings)
    unit = characteristic_time(model, runs.records, runs.length, settings.segment_s)
    first = find_start(problem, runs.records, WEAK_FORM_SHIP_LENGTHS * unit)
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


def warm_start(previous: WindowEstimate, model: Model, runs: Runs, settings: EstimateSettings) -> WindowEstimate:
    """The search continued on longer records, weights as the last residuals have them.

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
    shared[: len(problem.free)] = previous.value
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
