"""The protocol of every population optimiser: `ask` gives points of a box, `tell` takes their fitness.

A fitness is a number to be made small: half a sum of squares, a root mean square, a criterion. Infinity means that the
model cannot be evaluated there; NaN is refused.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from seatrial.numerics.optimise.least_squares import LeastSquaresProblem
from seatrial.numerics.optimise.solution import Array, Solution, Status


class SearchError(ValueError):
    """Input a search cannot run with, in one sentence; callers add where it came from."""


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds of a search, shapes (d,), in whatever unit the fitness takes.

    Raises:
        SearchError: bounds that are not finite, not of one shape, not in order, or too far apart for a number.
    """

    lower: Array
    upper: Array

    def __post_init__(self) -> None:
        lower, upper = (np.array(bound, dtype=np.float64, ndmin=1) for bound in (self.lower, self.upper))
        if lower.ndim != 1 or lower.shape != upper.shape or not lower.size:
            raise SearchError(f"Bounds need one shape (d,), but they have {lower.shape} and {upper.shape}.")
        with np.errstate(over="ignore", invalid="ignore"):
            wrong = np.flatnonzero(~(np.isfinite(lower) & np.isfinite(upper - lower) & (lower < upper)))
        if wrong.size:
            low, high = lower[wrong[0]], upper[wrong[0]]
            raise SearchError(
                f"Bound {wrong[0]} runs from {low} to {high}; give two numbers a finite way apart, the smaller first."
            )
        for name, bound in (("lower", lower), ("upper", upper)):
            bound.flags.writeable = False
            object.__setattr__(self, name, bound)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.lower)

    @property
    def width(self) -> Array:
        """Upper minus lower bound, shape (d,)."""
        return self.upper - self.lower

    def scaled(self, unit: Array) -> Array:
        """Return points of the unit box, shape (..., d), in this one."""
        return np.clip(self.lower + unit * self.width, self.lower, self.upper)

    def random_points(self, generator: np.random.Generator, count: int) -> Array:
        """Return points drawn uniformly, shape (count, d)."""
        return self.scaled(generator.random((count, self.size)))


class Optimiser(Protocol):
    """What a search asks of an optimiser.

    Attributes:
        done: whether its iterations are spent, or nothing is left to improve.
        best: the point it would return now, shape (d,), and its fitness.
        history: fitness of `best` after each iteration.
        trace: `best` after each iteration, shape (iterations, d).
        status: how it stands, for the solution.
        seed: of its generator, where that is one whole number.
    """

    def ask(self) -> Array:
        """Return points to evaluate next, shape (n, d), inside the box; the same until `tell` is called."""
        ...

    def tell(self, fitness: Array) -> None:
        """Take the fitness of the points asked about, shape (n,)."""
        ...

    @property
    def done(self) -> bool: ...

    @property
    def best(self) -> tuple[Array, float]: ...

    @property
    def history(self) -> tuple[float, ...]: ...

    @property
    def trace(self) -> Array: ...

    @property
    def status(self) -> Status: ...

    @property
    def seed(self) -> int | None: ...


def search(
    optimiser: Optimiser, fitness: Callable[[Array], Array], report_progress: Callable[[int, float], None] | None = None
) -> Solution:
    """Ask and tell until the optimiser is done; `fitness` takes (n, d) and gives (n,).

    `progress` is called after each iteration with the number of evaluations and the best fitness.

    Raises:
        SearchError: a fitness that is NaN or has another shape.
    """
    evaluations = 0
    while not optimiser.done:
        points = optimiser.ask()
        optimiser.tell(fitness(points))
        evaluations += len(points)
        if report_progress:
            report_progress(evaluations, optimiser.best[1])
    point, value = optimiser.best
    status = optimiser.status if np.isfinite(value) else Status.FAILED
    return Solution(point, value, status, evaluations, optimiser.history, optimiser.seed)


def fitness_function(problem: LeastSquaresProblem, local_unknowns: Array | None = None) -> Callable[[Array], Array]:
    """Return half the sum of squares of a least-squares problem at each row, local unknowns (s, m) held where given."""
    held = np.zeros((0, 0)) if local_unknowns is None else local_unknowns

    def fitness(points: Array) -> Array:
        return np.array([problem.cost(point, held) for point in points])

    return fitness
