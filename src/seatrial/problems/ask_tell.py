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
            points = _inside(optimiser.ask(), problem)
            optimiser.tell(problem.fitness(points))
            if problem.is_changing:
                problem.declare_best(optimiser.best[0])
    except BudgetSpent:
        pass  # the meter keeps that
    return Estimate(np.array(optimiser.best[0], dtype=np.float64))


def _inside(points: object, problem: PosedProblem) -> Array:
    """Return the points of an ask as an array."""
    array = np.array(points, dtype=np.float64)
    size, box = problem.box.size, problem.box
    if array.ndim != 2 or array.shape[1] != size or not len(array):
        raise MethodError(f"ask() returns the shape {array.shape}, not (n, {size})")
    if not np.all(np.isfinite(array)):
        raise MethodError("ask() returns a point that is not finite")
    outside = np.flatnonzero(np.any((array < box.lower) | (array > box.upper), axis=1))
    if outside.size:
        row, column = outside[0], int(np.argmax((array < box.lower)[outside[0]] | (array > box.upper)[outside[0]]))
        raise MethodError(
            f"ask() leaves the box: {problem.unknowns[column]} = {array[row, column]:g}, allowed are "
            f"{box.lower[column]:g} to {box.upper[column]:g}; clip it"
        )
    return array
