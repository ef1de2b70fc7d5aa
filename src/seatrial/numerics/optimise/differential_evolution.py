"""Differential evolution rand/1/bin (Storn & Price 1997, Journal of Global Optimization 11, 341-359)."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise.least_squares import Array
from seatrial.numerics.optimise.population import Box, FitnessMemory, Population, SearchError, reject_nonfinite_settings


@dataclass(frozen=True)
class EvolutionSettings:
    """Settings of differential evolution, in the notation of Storn & Price 1997.

    Attributes:
        population: vectors, NP.
        iterations: populations evaluated, the first included.
        F: weight of a difference of two vectors.
        CR: probability that a component is taken from the mutant.
        memory: what becomes of the vectors' fitness.
    """

    population: int = 40
    iterations: int = 200
    F: float = 0.5
    CR: float = 0.9
    memory: FitnessMemory = FitnessMemory.KEEP

    def __post_init__(self) -> None:
        reject_nonfinite_settings(self)
        if self.population < 4:
            raise SearchError(f"Differential evolution needs at least 4 vectors, not {self.population}.")
        if not 0 <= self.CR <= 1:
            raise SearchError(f"The crossover probability CR lies between 0 and 1, not at {self.CR}.")


class DifferentialEvolution(Population):
    """Each vector against a trial made from three others; the better of the two lives on.

    Ours: a component beyond the box is put half-way between its parent and the wall. With `Memory.RE_EVALUATE` the
    parents, shape (population, d), follow the trials in every ask but the first.
    """

    def __init__(self, box: Box, generator: np.random.Generator, settings: EvolutionSettings | None = None) -> None:
        self.settings = settings or EvolutionSettings()
        super().__init__(box, generator, self.settings.iterations)
        self._x = box.random_points(generator, self.settings.population)
        self._fitness = np.full(len(self._x), np.inf)

    @property
    def best(self) -> tuple[Array, float]:
        """Best vector and its fitness."""
        first = int(np.argmin(self._fitness))
        return self._x[first].copy(), float(self._fitness[first])

    def _propose(self) -> Array:
        if self.iteration == 0:
            return self._x
        trials = self._trial_vectors()
        return trials if self.settings.memory is FitnessMemory.KEEP else np.concatenate([trials, self._x])

    def _learn(self, points: Array, fitness: Array) -> None:
        count = len(self._x)
        if len(fitness) > count:
            self._fitness = fitness[count:]
        better = fitness[:count] <= self._fitness
        self._x = np.where(better[:, None], points[:count], self._x)
        self._fitness = np.where(better, fitness[:count], self._fitness)

    def _trial_vectors(self) -> Array:
        x, generator, box = self._x, self._generator, self.box
        count, size = x.shape
        order = generator.random((count, count))
        np.fill_diagonal(order, np.inf)
        r1, r2, r3 = np.argpartition(order, (0, 1, 2), axis=1)[:, :3].T
        mutant = x[r1] + self.settings.F * (x[r2] - x[r3])  # eq. 2
        crossing = generator.random(x.shape) <= self.settings.CR
        crossing[np.arange(count), generator.integers(size, size=count)] = True
        trial = np.where(crossing, mutant, x)  # eqs. 3 and 4
        trial = np.where(trial < box.lower, (x + box.lower) / 2, trial)
        return np.where(trial > box.upper, (x + box.upper) / 2, trial)
