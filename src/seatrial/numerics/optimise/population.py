"""What population optimisers share: the protocol of ask and tell, the record of the best, dominance."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields
from enum import Enum
from math import isfinite
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from seatrial.numerics.optimise.least_squares import Array, LeastSquaresProblem, Solution, Status

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


# The protocol of every population optimiser: `ask` gives points of a box, `tell` takes their fitness.


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


# Which points of several objectives no other point beats, and how much they beat together.


def non_dominated(objectives: Array) -> NDArray[np.intp]:
    """Return rows no other row is as small as in every objective and smaller in one, shape (k,), in rising order.

    `objectives` has the shape (n, m), each to be made small; a row with infinity or NaN takes no part, and of equal
    rows the first stands for all.
    """
    from moocore import is_nondominated

    finite = np.flatnonzero(np.isfinite(objectives).all(axis=1))
    if not finite.size:
        return finite
    kept = finite[np.asarray(is_nondominated(objectives[finite], keep_weakly=False), dtype=bool)]
    return kept[np.lexsort(objectives[kept].T[::-1])]


def hypervolume(objectives: Array, reference: Array) -> float:
    """Return the volume that the points (n, m) dominate within the reference point (m,)."""
    from moocore import hypervolume as volume

    return float(volume(objectives, ref=reference))


# What the population optimisers share: the order of ask and tell, what is refused, the record of the best.


class FitnessMemory(Enum):
    """What becomes of the fitness of remembered points (own bests, leaders) from one iteration to the next.

    KEEP: it stays, right where the fitness is one function.
    RE_EVALUATE: remembered points are asked about again with every population, for a fitness that changes from
        iteration to iteration; comparisons are then made under one fitness, and the history need not fall.
    """

    KEEP = "keep"
    RE_EVALUATE = "re-evaluate"


class Population(ABC):
    """An optimiser that moves a population inside a box; one `ask()` and one `tell()` make an iteration.

    A kind says where the points go (`_propose`), what it makes of their fitness (`_learn`), and its best point; one of
    several objectives also which values it refuses (`_refuse`). The first population counts as the first of the
    `iterations`.
    """

    def __init__(self, box: Box, generator: np.random.Generator, iterations: int) -> None:
        if iterations < 1:
            raise SearchError(f"A search needs at least 1 iteration, not {iterations}.")
        self.box = box
        self.iterations = iterations
        self._generator = generator
        self._seed = integer_seed(generator)
        self._pending_points: Array | None = None
        self._history: list[float] = []
        self._trace: list[Array] = []

    @abstractmethod
    def _propose(self) -> Array:
        """Return points to ask about, shape (n, d); they are clipped to the box."""

    @abstractmethod
    def _learn(self, points: Array, fitness: Array) -> None:
        """Take in the fitness (n,) of the points (n, d)."""

    @property
    @abstractmethod
    def best(self) -> tuple[Array, float]:
        """Return the best point so far, shape (d,), and its fitness; infinite before the first `tell()`."""

    def ask(self) -> Array:
        """Return points to evaluate next, shape (n, d), a copy; the same until `tell` is called."""
        if self._pending_points is None:
            self._pending_points = np.clip(self._propose(), self.box.lower, self.box.upper)
        return self._pending_points.copy()

    def tell(self, fitness: Array) -> None:
        """Take the fitness of the points asked about, shape (n,).

        Raises:
            SearchError: nothing was asked; a fitness of another shape; NaN or minus infinity, naming the row.
        """
        if self._pending_points is None:
            raise SearchError("A fitness was given before ask() was called; call ask() first.")
        values = np.array(fitness, dtype=np.float64)
        self._validate(self._pending_points, values)
        self._learn(self._pending_points, values)
        self._pending_points = None
        point, value = self.best
        self._history.append(value)
        self._trace.append(point)

    def _validate(self, points: Array, values: Array) -> None:
        """Raise SearchError where the values given for the points (n, d) cannot be a fitness (n,)."""
        if values.shape != (len(points),):
            raise SearchError(f"A fitness for {len(points)} points has shape {values.shape}; give one number a point.")
        wrong = np.flatnonzero(np.isnan(values) | (values == -np.inf))
        if wrong.size:
            row = wrong[0]
            raise SearchError(
                f"The fitness of row {row} in iteration {self.iteration} is {values[row]} "
                f"at {np.array2string(points[row], precision=6)}; "
                "return infinity where the model cannot be evaluated."
            )

    @property
    def iteration(self) -> int:
        """Number of populations evaluated so far: the index of the present one, from 0."""
        return len(self._history)

    @property
    def done(self) -> bool:
        """Whether the iterations are spent."""
        return self.iteration >= self.iterations

    @property
    def status(self) -> Status:
        """Populations end with their budget; nothing proves their best point a minimum."""
        return Status.EXHAUSTED

    @property
    def history(self) -> tuple[float, ...]:
        """Return the fitness of the best point after each iteration."""
        return tuple(self._history)

    @property
    def trace(self) -> Array:
        """Return the best point (own best of all, waterhole) after each iteration, shape (iterations, d)."""
        return np.array(self._trace).reshape(-1, self.box.size)

    @property
    def seed(self) -> int | None:
        """Seed of the generator, where it is one whole number and the generator is not a descendant."""
        return self._seed


def reject_nonfinite_settings(settings: "DataclassInstance") -> None:
    """Raise SearchError where a number among the settings is NaN or infinite: it would move points nowhere."""
    for field in fields(settings):
        value = getattr(settings, field.name)
        if isinstance(value, float) and not isfinite(value):
            raise SearchError(f"Setting {field.name} is {value}; give a finite number.")


def integer_seed(generator: np.random.Generator) -> int | None:
    """Return the seed of a generator, where it is one whole number and the generator is not a descendant."""
    sequence = generator.bit_generator.seed_seq
    if isinstance(sequence, np.random.SeedSequence) and not sequence.spawn_key and isinstance(sequence.entropy, int):
        return sequence.entropy
    return None
