"""An optimiser to copy: random points round the best one, in a neighbourhood that shrinks from the whole box."""

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box
from seatrial.numerics.optimise.population import Population

POPULATION, ITERATIONS = 40, 200
"""Points of a population and populations of a search; chosen, as the published methods have them."""
SMALLEST = 1e-6
"""Half width of the last neighbourhood as a share of the box's; chosen."""


class ShrinkingSearch(Population):
    """Uniform random points round the best point; half widths fall geometrically from the box's to `SMALLEST` of it."""

    def __init__(self, box: Box, generator: np.random.Generator, iterations: int = ITERATIONS) -> None:
        super().__init__(box, generator, iterations)
        self._best, self._best_fitness = box.scaled(np.full(box.size, 0.5)), np.inf

    @property
    def best(self) -> tuple[Array, float]:
        """Best point so far, shape (d,), and its fitness; the middle of the box before the first `tell()`."""
        return self._best.copy(), self._best_fitness

    def _propose(self) -> Array:
        half_width = self.box.width * SMALLEST ** (self.iteration / self.iterations)
        return self._best + half_width * self._generator.uniform(-1.0, 1.0, (POPULATION, self.box.size))

    def _learn(self, points: Array, fitness: Array) -> None:
        least = int(np.argmin(fitness))
        if fitness[least] < self._best_fitness:
            self._best, self._best_fitness = points[least].copy(), float(fitness[least])
