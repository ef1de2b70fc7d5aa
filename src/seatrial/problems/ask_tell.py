"""Optimisers that ask and tell, run within a budget and held to their box."""

from typing import Protocol, runtime_checkable

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.problems.estimate import Estimate
from seatrial.problems.posed import BudgetSpent, PosedProblem


class MethodError(InputError):
    """States what a method does that it may not, in one sentence."""


@runtime_checkable
class Asking(Protocol):
    """What makes a class an optimiser."""

    def ask(self) -> Array:
        """Return points to evaluate next, (n, d), inside the box."""
        ...

    def tell(self, fitness: Array) -> None:
        """Take their fitness (n,)."""
        ...


class AskTell(Asking, Protocol):
    """What a run asks of an optimiser; `done` may be absent, its budget then ends it."""

    @property
    def best(self) -> tuple[Array, float]:
        """Return the point it would answer now (d,), and its fitness."""
        ...


def searched(optimiser: AskTell, problem: PosedProblem) -> Estimate:
    """Return the best point of an optimiser that has run to its end, or to that of the budget.

    Raises:
        MethodError: points of another shape, not finite, or outside the box.
    """
    try:
        while not getattr(optimiser, "done", False):
            points = np.asarray(optimiser.ask(), dtype=np.float64)
            if not _is_inside(points, problem):
                raise _misplaced(points, problem)
            optimiser.tell(problem.fitness_inside(points))
            if problem.is_changing:
                problem.declare_best(optimiser.best[0])
    except BudgetSpent:
        pass  # the meter keeps that
    return Estimate(np.array(optimiser.best[0], dtype=np.float64))


def _is_inside(points: Array, problem: PosedProblem) -> bool:
    """Whether the points of an ask have their shape and lie in the box; those that are not finite do not."""
    box = problem.box
    has_shape = points.ndim == 2 and points.shape[1] == box.size and len(points) > 0
    # counted, as `all` costs three times what the comparison does
    return (
        has_shape
        and np.count_nonzero(points >= box.lower) == points.size
        and np.count_nonzero(points <= box.upper) == points.size
    )


def _misplaced(points: Array, problem: PosedProblem) -> MethodError:
    """What is wrong with the points of an ask."""
    size, box = problem.box.size, problem.box
    if points.ndim != 2 or points.shape[1] != size or not len(points):
        return MethodError(f"ask() returns the shape {points.shape}, not (n, {size})")
    if not np.all(np.isfinite(points)):
        return MethodError("ask() returns a point that is not finite")
    row, column = np.argwhere((points < box.lower) | (points > box.upper))[0]
    return MethodError(
        f"ask() leaves the box: {problem.unknowns[column]} = {points[row, column]:g}, allowed are "
        f"{box.lower[column]:g} to {box.upper[column]:g}; clip it"
    )
