"""Profile likelihood: one coefficient held at a value, all others fitted again.

Raue et al. 2009, Bioinformatics 25, 1923. The interval follows curved valleys that a covariance takes for straight
ones. A coefficient that is held keeps its prior, so that the costs of all values compare.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.core.results import Profile
from seatrial.core.values import Array, ProgressReporter
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.numerics.workers import map_in_threads

CHI_SQUARED_LIMIT = 3.841
"""95 % quantile of chi squared with one degree of freedom."""

# refits on each side of an estimate, and standard errors they reach at most, ours
_MAX_POINTS_PER_SIDE, _MAX_DEVIATIONS = 8, 5.0
# promised decrease of the cost at which a refit ends, ours
_NEGLIGIBLE = 1e-4
# relative difference of costs that count as one, ours
_COST_TOLERANCE = 1e-6


def profiles(
    estimate: PointEstimate, deviations: Array, names: Sequence[str], report_progress: ProgressReporter | None = None
) -> tuple[Profile, ...]:
    """The profile of each named coefficient; none where the estimate minimises another criterion (prediction error).

    deviations: standard errors of all free ones, (free,); first steps are half of them or of the information's, if
    those are smaller.
    """
    if not _is_minimum_of_its_problem(estimate):
        return ()
    place = {n: i for i, n in enumerate(estimate.problem.free)}
    own_errors = np.sqrt(np.diag(inverse(estimate.optimum.normal.without_local()[1])))
    done: list[int] = []

    def one(name: str) -> Profile:
        profile = _profile(estimate, place[name], float(min(deviations[place[name]], own_errors[place[name]])))
        done.append(1)
        if report_progress:
            report_progress(f"profile likelihood: {len(done)} of {len(names)}")
        return profile

    return tuple(map_in_threads(one, list(names), workers=estimate.problem.workers))


def _is_minimum_of_its_problem(estimate: PointEstimate) -> bool:
    cost = estimate.problem.cost(estimate.common_parameters, estimate.optimum.local)
    return bool(np.isclose(cost, estimate.optimum.solution.value, rtol=_COST_TOLERANCE, atol=_COST_TOLERANCE))


def _profile(estimate: PointEstimate, column: int, deviation: float) -> Profile:
    centre = (float(estimate.common_parameters[column]), 2.0 * estimate.optimum.solution.value)
    below, above = (_branch(estimate, column, sign * deviation) for sign in (-1.0, 1.0))
    values, costs = np.array([*reversed(below), centre, *above]).T
    costs = costs - np.min(costs)
    least = int(np.argmin(costs))
    return Profile(
        estimate.problem.free[column],
        tuple(map(float, values)),
        tuple(map(float, costs)),
        _crossing(values[least::-1], costs[least::-1]),
        _crossing(values[least:], costs[least:]),
    )


def _branch(estimate: PointEstimate, column: int, step: float) -> list[tuple[float, float]]:
    """Values and twice the loss, outward until the limit is passed, or bound, reach or the model's range is at its end.

    Where a refit finds a smaller loss than the estimate's, the limit counts from there.
    """
    held = _hold_coefficient(estimate, column)
    shared, local = np.delete(estimate.common_parameters, column), estimate.optimum.local
    low, high = estimate.problem.lower[column], estimate.problem.upper[column]
    least, away, points = 2.0 * estimate.optimum.solution.value, 0.5, []
    while away <= _MAX_DEVIATIONS and len(points) < _MAX_POINTS_PER_SIDE:
        value = float(estimate.common_parameters[column]) + away * step
        if not low <= value <= high:
            break
        problem, known = held(value)
        again = levenberg_marquardt(problem, shared, local, negligible=_NEGLIGIBLE)
        cost = 2.0 * again.solution.value + known
        if not np.isfinite(cost):
            break
        shared, local, least = again.solution.point, again.local, min(least, cost)
        points.append((value, cost))
        if cost - least > CHI_SQUARED_LIMIT:
            break
        away += 0.5 if away < 2.5 else 1.25  # steps in standard errors, longer in the tails; chosen
    return points


def _hold_coefficient(estimate: PointEstimate, column: int) -> Callable[[float], tuple[OutputError, float]]:
    """The problem with one coefficient fixed and twice the cost of its own prior, as functions of its value."""
    problem, name = estimate.problem, estimate.problem.free[column]
    model = problem.model.with_parameters(problem.model.parameters.fixed(name))
    mean, weight = (float(of_all[column]) for of_all in problem.priors)

    def problem_at(value: float) -> tuple[OutputError, float]:
        known = weight * (value - mean) ** 2
        return replace(problem, model=model.with_values({name: value}), workers=1), known

    return problem_at


def _crossing(values: Array, costs: Array) -> float | None:
    """Where the cost passes the limit, by interpolating its root (straight for a parabola); None where it does not."""
    for (a, low), (b, high) in pairwise(zip(values, costs, strict=True)):
        if low < CHI_SQUARED_LIMIT <= high:
            share = (np.sqrt(CHI_SQUARED_LIMIT) - np.sqrt(low)) / (np.sqrt(high) - np.sqrt(low))
            return float(a + share * (b - a))
    return None
