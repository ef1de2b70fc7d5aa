"""Levenberg-Marquardt from several starts, until one gives an acceptable value."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise.least_squares import Array, LeastSquaresProblem, Optimum, Solution, levenberg_marquardt
from seatrial.numerics.optimise.population import Box, SearchError, integer_seed


@dataclass(frozen=True)
class RestartSettings:
    """How often, and until when, to start again.

    Attributes:
        acceptable_cost: value (half the sum of squares) at or below which a fit is taken; for residuals in standard
            deviations half a quantile of chi-square with the degrees of freedom of the data.
        max_restarts: restarts at most, after the first start.
        evaluations: of each start.
        negligible: promised decrease below which a start ends.
    """

    acceptable_cost: float
    max_restarts: int = 4
    evaluations: int = 100
    negligible: float = 0.0

    def __post_init__(self) -> None:
        if self.max_restarts < 0 or self.evaluations < 1:
            raise SearchError(
                f"A search of {self.max_restarts} restarts with {self.evaluations} evaluations each is none; "
                "give 0 or more restarts and 1 or more evaluations."
            )
        if np.isnan(self.acceptable_cost):
            raise SearchError("The acceptable value is NaN; give the largest half sum of squares that is taken.")


@dataclass(frozen=True, eq=False)
class Multistart:
    """The best of several starts.

    Attributes:
        optimum: solution (evaluations and history over all starts), local unknowns, Gauss-Newton model.
        restarts: starts made after the first.
        is_accepted: whether the value is acceptable; if not, all restarts are spent.
    """

    optimum: Optimum
    restarts: int
    is_accepted: bool

    @property
    def solution(self) -> Solution:
        """What was found."""
        return self.optimum.solution


def multistart(
    problem: LeastSquaresProblem,
    start: Array,
    box: Box,
    generator: np.random.Generator,
    restarts: RestartSettings,
    *,
    local: Array | None = None,
    transform: Callable[[Array], Array] | None = None,
) -> Multistart:
    """Start at `start`, then at points drawn from the box, until the value is acceptable; the best one is returned.

    Args:
        start: shape (n,).
        local: local unknowns at every start, shape (s, m).
        scaled: from the box's coordinates to the problem's, where starts are not drawn uniformly in these
            (`np.exp` of a box of logarithms).

    Raises:
        SearchError: a start of another size than the box.
    """
    if np.shape(start) != (box.size,):
        raise SearchError(f"The start has shape {np.shape(start)}, but the box has {box.size} unknowns.")
    held = np.zeros((0, 0)) if local is None else local
    best: Optimum | None = None
    evaluations, history, count = 0, [], -1
    at = start
    while best is None or (not best.solution.value <= restarts.acceptable_cost and count < restarts.max_restarts):
        if best is not None:
            drawn = box.random_points(generator, 1)[0]
            at = transform(drawn) if transform else drawn
        found = levenberg_marquardt(problem, at, held, evaluations=restarts.evaluations, negligible=restarts.negligible)
        count += 1
        evaluations += found.solution.evaluations
        if best is None or found.solution.value < best.solution.value or np.isnan(best.solution.value):
            best = found
        history.append(best.solution.value)
    s = best.solution
    solution = Solution(s.point, s.value, s.status, evaluations, tuple(history), integer_seed(generator))
    return Multistart(Optimum(solution, best.local, best.normal), count, s.value <= restarts.acceptable_cost)
