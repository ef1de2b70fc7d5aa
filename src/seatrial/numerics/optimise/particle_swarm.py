"""Particle swarm (Kennedy & Eberhart 1995), as Qi et al. 2025 print it in eq. 29."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise.ask_tell import Box, SearchError
from seatrial.numerics.optimise.population import FitnessMemory, Population, reject_nonfinite_settings
from seatrial.numerics.optimise.solution import Array


@dataclass(frozen=True)
class SwarmSettings:
    """Settings of a particle swarm.

    Qi et al. 2025 print neither omega nor c1 and c2: the defaults are ours, the constriction values of Clerc & Kennedy
    2002. Their population is 40, their iterations 200.

    Attributes:
        population: particles.
        iterations: populations evaluated, the first included.
        omega: inertia weight.
        c1, c2: pull towards the own best and the best of all.
        velocity_limit: largest velocity, as a share of the box's width; ours.
        memory: what becomes of the own bests' fitness.
    """

    population: int = 40
    iterations: int = 200
    omega: float = 0.7298
    c1: float = 1.49618
    c2: float = 1.49618
    velocity_limit: float = 1.0
    memory: FitnessMemory = FitnessMemory.KEEP

    def __post_init__(self) -> None:
        reject_nonfinite_settings(self)
        if self.population < 2:
            raise SearchError(f"A particle swarm needs at least 2 particles, not {self.population}.")
        if not self.velocity_limit > 0:
            raise SearchError(f"The velocity limit is a positive share of the box's width, not {self.velocity_limit}.")


class ParticleSwarm(Population):
    """Particles drawn to their own best point and to the best of all (qi2025 eq. 29).

    The random numbers r1, r2 are drawn for every component. Ours, as the print is silent: particles start with half
    the way to a random point of the box as velocity; one that would leave the box stays on its wall, and its velocity
    across the wall becomes zero (Clerc's standard particle swarm of 2006). The whole swarm moves before it is
    evaluated. With `Memory.RE_EVALUATE` the own bests, shape (population, d), follow the particles in every ask but
    the first.
    """

    def __init__(self, box: Box, generator: np.random.Generator, settings: SwarmSettings | None = None) -> None:
        self.settings = settings or SwarmSettings()
        super().__init__(box, generator, self.settings.iterations)
        count = self.settings.population
        self._x = box.random_points(generator, count)
        self._velocity = (box.random_points(generator, count) - self._x) / 2
        self._fitness = np.full(count, np.inf)
        self._personal_best, self._personal_best_fitness = self._x.copy(), self._fitness.copy()

    @property
    def best(self) -> tuple[Array, float]:
        """Best of the particles' own bests, and its fitness."""
        first = int(np.argmin(self._personal_best_fitness))
        return self._personal_best[first].copy(), float(self._personal_best_fitness[first])

    def _propose(self) -> Array:
        if self.iteration == 0:
            return self._x
        self._move()
        if self.settings.memory is FitnessMemory.KEEP:
            return self._x
        return np.concatenate([self._x, self._personal_best])

    def _learn(self, points: Array, fitness: Array) -> None:
        count = len(self._x)
        self._x, self._fitness = points[:count], fitness[:count]
        if len(fitness) > count:
            self._personal_best_fitness = fitness[count:].copy()
        better = self._fitness < self._personal_best_fitness
        self._personal_best[better], self._personal_best_fitness[better] = self._x[better], self._fitness[better]

    def _inertia(self) -> Array:
        """Inertia weight of each particle, shape (population, 1) or (1, 1)."""
        return np.array([[self.settings.omega]])

    def _move(self) -> None:
        """One step of every particle, eq. 29."""
        settings, box = self.settings, self.box
        r1, r2 = self._generator.random((2, *self._x.shape))
        own, social = self._personal_best - self._x, self.best[0] - self._x
        velocity = self._inertia() * self._velocity + settings.c1 * r1 * own + settings.c2 * r2 * social
        limit = settings.velocity_limit * box.width
        velocity = np.clip(velocity, -limit, limit)
        free = self._x + velocity
        self._x = np.clip(free, box.lower, box.upper)
        self._velocity = np.where(free == self._x, velocity, 0.0)
