"""Profile likelihood: one coefficient held at a value, all others fitted again.

Raue et al. 2009, Bioinformatics 25, 1923. The interval follows curved valleys that a covariance takes for straight
ones. A coefficient that is held keeps its prior, so that the costs of all values compare.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.core.results import Profile
from seatrial.core.values import Array, Progress
from seatrial.estimation.estimate.estimate import Estimate
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.numerics.workers import mapped

LIMIT = 3.841
"""95 % quantile of chi squared with one degree of freedom."""

_EACH_SIDE, _REACH = 8, 5.0
_NEGLIGIBLE = 1e-4
_OWN = 1e-6


def profiles(
    made: Estimate, deviations: Array, names: Sequence[str], progress: Progress | None = None
) -> tuple[Profile, ...]:
    """The profile of each named coefficient; none where the estimate minimises another criterion (prediction error).

    deviations: standard errors of all free ones, (free,); first steps are half of them or of the information's, if
    those are smaller.
    """
    if not _is_minimum_of_its_problem(made):
        return ()
    place = {n: i for i, n in enumerate(made.problem.free)}
    own = np.sqrt(np.diag(inverse(made.optimum.normal.reduced()[1])))
    done: list[int] = []

    def one(name: str) -> Profile:
        found = _profile(made, place[name], float(min(deviations[place[name]], own[place[name]])))
        done.append(1)
        if progress:
            progress(f"profile likelihood: {len(done)} of {len(names)}")
        return found

    return tuple(mapped(one, list(names), workers=made.problem.workers))


def _is_minimum_of_its_problem(made: Estimate) -> bool:
    cost = made.problem.cost(made.shared, made.optimum.local)
    return bool(np.isclose(cost, made.optimum.solution.value, rtol=_OWN, atol=_OWN))


def _profile(made: Estimate, column: int, deviation: float) -> Profile:
    centre = (float(made.shared[column]), 2.0 * made.optimum.solution.value)
    below, above = (_branch(made, column, sign * deviation) for sign in (-1.0, 1.0))
    values, costs = np.array([*reversed(below), centre, *above]).T
    costs = costs - np.min(costs)
    least = int(np.argmin(costs))
    return Profile(
        made.problem.free[column],
        tuple(map(float, values)),
        tuple(map(float, costs)),
        _crossing(values[least::-1], costs[least::-1]),
        _crossing(values[least:], costs[least:]),
    )


def _branch(made: Estimate, column: int, step: float) -> list[tuple[float, float]]:
    """Values and twice the loss, outward until the limit is passed, or bound, reach or the model's range is at its end.

    Where a refit finds a smaller loss than the estimate's, the limit counts from there.
    """
    held = _holding(made, column)
    shared, local = np.delete(made.shared, column), made.optimum.local
    low, high = made.problem.lower[column], made.problem.upper[column]
    least, away, found = 2.0 * made.optimum.solution.value, 0.5, []
    while away <= _REACH and len(found) < _EACH_SIDE:
        value = float(made.shared[column]) + away * step
        if not low <= value <= high:
            break
        problem, known = held(value)
        again = levenberg_marquardt(problem, shared, local, negligible=_NEGLIGIBLE)
        cost = 2.0 * again.solution.value + known
        if not np.isfinite(cost):
            break
        shared, local, least = again.solution.point, again.local, min(least, cost)
        found.append((value, cost))
        if cost - least > LIMIT:
            break
        away += 0.5 if away < 2.5 else 1.25
    return found


def _holding(made: Estimate, column: int) -> Callable[[float], tuple[OutputError, float]]:
    """The problem with one coefficient fixed and twice the cost of its own prior, as functions of its value."""
    problem, name = made.problem, made.problem.free[column]
    model = problem.model.with_parameters(problem.model.parameters.fixed(name))
    mean, weight = (float(of_all[column]) for of_all in problem.priors)

    def at(value: float) -> tuple[OutputError, float]:
        known = weight * (value - mean) ** 2
        return replace(problem, model=model.with_values({name: value}), workers=1), known

    return at


def _crossing(values: Array, costs: Array) -> float | None:
    """Where the cost passes the limit, by interpolating its root (straight for a parabola); None where it does not."""
    for (a, low), (b, high) in pairwise(zip(values, costs, strict=True)):
        if low < LIMIT <= high:
            share = (np.sqrt(LIMIT) - np.sqrt(low)) / (np.sqrt(high) - np.sqrt(low))
            return float(a + share * (b - a))
    return None
