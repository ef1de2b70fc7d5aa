"""Profile likelihood: one coefficient held at a value, all others fitted again.

Raue et al. 2009, Bioinformatics 25, 1923. The interval follows curved valleys that a covariance takes for straight
ones.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.estimate.estimate import Estimate
from seatrial.optimise import levenberg_marquardt
from seatrial.problem.output_error import OutputError
from seatrial.results import Profile
from seatrial.values import Array, Progress
from seatrial.workers import mapped

LIMIT = 3.841
"""95 % quantile of chi squared with one degree of freedom."""

_STEPS, _REACH = 4, 5.0
_NEGLIGIBLE = 1e-4


def profiles(
    made: Estimate, deviations: Array, names: Sequence[str], progress: Progress | None = None
) -> tuple[Profile, ...]:
    """The profile of each named coefficient; deviations: standard errors of all free ones, (free,), for first steps."""
    place = {n: i for i, n in enumerate(made.problem.free)}
    done: list[int] = []

    def one(name: str) -> Profile:
        found = _profile(made, place[name], float(deviations[place[name]]))
        done.append(1)
        if progress:
            progress(f"profile likelihood: {len(done)} of {len(names)}")
        return found

    return tuple(mapped(one, list(names), workers=made.problem.workers))


def _profile(made: Estimate, column: int, deviation: float) -> Profile:
    centre = float(made.shared[column])
    below, above = (_branch(made, column, sign * deviation) for sign in (-1.0, 1.0))
    values = [v for v, _ in reversed(below)] + [centre] + [v for v, _ in above]
    costs = [c for _, c in reversed(below)] + [0.0] + [c for _, c in above]
    return Profile(
        made.problem.free[column],
        tuple(values),
        tuple(costs),
        _crossing([(centre, 0.0), *below]),
        _crossing([(centre, 0.0), *above]),
    )


def _branch(made: Estimate, column: int, step: float) -> list[tuple[float, float]]:
    """Values and twice the loss above the minimum, outward until the limit is passed or the reach is at its end."""
    held = _holding(made, column)
    shared, local = np.delete(made.shared, column), made.optimum.local
    least, away, found = made.optimum.solution.value, 0.5, []
    while away <= _REACH and (not found or found[-1][1] < LIMIT) and len(found) < 2 * _STEPS:
        value = float(made.shared[column]) + away * step
        problem = held(value)
        again = levenberg_marquardt(problem, shared, local, negligible=_NEGLIGIBLE)
        shared, local = again.solution.point, again.local
        found.append((value, max(2.0 * (again.solution.value - least), 0.0)))
        away += 0.5 if away < 2.5 else 1.25
    return found


def _holding(made: Estimate, column: int) -> Callable[[float], OutputError]:
    """The problem with one coefficient fixed, as a function of its value."""
    problem, name = made.problem, made.problem.free[column]
    model = problem.model.with_parameters(problem.model.parameters.fixed(name))

    def at(value: float) -> OutputError:
        return replace(problem, model=model.with_values({name: value}), workers=1)

    return at


def _crossing(points: Sequence[tuple[float, float]]) -> float | None:
    """Where the cost passes the limit, by interpolating its root (straight for a parabola); None where it does not."""
    for (a, low), (b, high) in pairwise(points):
        if low < LIMIT <= high:
            share = (np.sqrt(LIMIT) - np.sqrt(low)) / (np.sqrt(high) - np.sqrt(low))
            return float(a + share * (b - a))
    return None
