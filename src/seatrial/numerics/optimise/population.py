"""What the population optimisers share: the order of ask and tell, what is refused, the record of the best."""

from abc import ABC, abstractmethod
from dataclasses import fields
from enum import Enum
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from seatrial.numerics.optimise.ask_tell import Box, SearchError
from seatrial.numerics.optimise.solution import Array, Status

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


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
