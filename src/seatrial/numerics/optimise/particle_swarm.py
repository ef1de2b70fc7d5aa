"""Particle swarm (Kennedy & Eberhart 1995), as Qi et al. 2025 print it in eq. 29."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise.least_squares import Array
from seatrial.numerics.optimise.population import Box, FitnessMemory, Population, SearchError, reject_nonfinite_settings


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
        """Return the inertia weight of each particle, shape (population, 1) or (1, 1)."""
        return np.array([[self.settings.omega]])

    def _move(self) -> None:
        """Move every particle one step, eq. 29."""
        settings, box = self.settings, self.box
        r1, r2 = self._generator.random((2, *self._x.shape))
        own, social = self._personal_best - self._x, self.best[0] - self._x
        velocity = self._inertia() * self._velocity + settings.c1 * r1 * own + settings.c2 * r2 * social
        limit = settings.velocity_limit * box.width
        velocity = np.clip(velocity, -limit, limit)
        free = self._x + velocity
        self._x = np.clip(free, box.lower, box.upper)
        self._velocity = np.where(free == self._x, velocity, 0.0)


@dataclass(frozen=True)
class CloudSettings(SwarmSettings):
    """Settings of the cloud particle swarm, as Meng et al. 2014 print them below eqs. 6 and 7.

    `omega` is not used. The velocity limit and the spread of the mutation are not printed; ours.

    Attributes:
        population, iterations: particles, and populations evaluated, the first included (Meng et al. 2014).
        c1, c2: pull towards the own best and the best of all (Meng et al. 2014).
        velocity_limit: largest velocity, as a share of the box's width; ours.
        w1, w2: largest and smallest inertia weight.
        A, B: thresholds on the best fitness over a particle's own, between bad and middling, middling and good.
        En, He: entropy and hyper-entropy of the weight's cloud; its expectation is Ex = 5 w1 - w2.
        p_m: probability that a particle which is not good becomes a drop of the cloud round the best.
        spread: En of that cloud as a share of the box's width, at the start; it shrinks linearly to zero.
    """

    population: int = 60
    iterations: int = 1000
    c1: float = 2.05
    c2: float = 2.05
    velocity_limit: float = 0.2
    w1: float = 0.9
    w2: float = 0.4
    A: float = 0.15
    B: float = 0.93
    En: float = 5.0
    He: float = 0.5
    p_m: float = 0.2
    spread: float = 0.1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.p_m <= 1:
            raise SearchError(f"The mutation probability p_m lies between 0 and 1, not at {self.p_m}.")
        if not self.A <= self.B:
            raise SearchError(f"Threshold A = {self.A} must not exceed threshold B = {self.B}.")
        for name, value in (("He", self.He), ("spread", self.spread)):
            if value < 0:
                raise SearchError(f"Setting {name} is the width of a normal law, not {value}; give 0 or more.")


class CloudParticleSwarm(ParticleSwarm):
    """Meng et al. 2014, eqs. 4-6, completed where the print is illegible.

    Eq. 4 prints no inertia weight though eq. 6 sets it: it multiplies the velocity. Of eq. 6 only the constants are
    left; its form is that of the normal cloud in their reference to Wei et al. 2009. Which particles mutate, and with
    which cloud, is lost: ours are those whose ratio does not exceed B, spread as in the settings with He = En / 10.
    Ratios of fitness need a fitness that is nowhere negative.
    """

    def __init__(self, box: Box, generator: np.random.Generator, settings: CloudSettings | None = None) -> None:
        self.cloud_settings = settings or CloudSettings()
        super().__init__(box, generator, self.cloud_settings)

    def _learn(self, points: Array, fitness: Array) -> None:
        if np.min(fitness) < 0:
            row = int(np.argmin(fitness))
            raise SearchError(
                f"The cloud particle swarm takes ratios of fitness, but row {row} has {fitness[row]:g}; "
                "use one that is nowhere negative."
            )
        super()._learn(points, fitness)

    def _inertia(self) -> Array:
        c = self.cloud_settings
        ratio = self._fitness_ratio()
        # En' ~ N(En, He), then eq. 6 with Ex = 5 w1 - w2
        entropy = self._generator.normal(c.En, c.He, len(ratio))
        # Meng et al. 2014, in the weight of the middle group
        away = (ratio - (5 * c.w1 - c.w2)) / np.where(entropy == 0.0, np.finfo(float).tiny, entropy)
        cloud = c.w1 - (c.w1 - c.w2) * np.exp(-0.5 * away**2)
        return np.where(ratio > c.B, c.w2, np.where(ratio < c.A, c.w1, cloud))[:, None]

    def _move(self) -> None:
        good = self._fitness_ratio() > self.cloud_settings.B
        super()._move()
        count = len(self._x)
        entropy = self.cloud_settings.spread * (1 - self.iteration / self.iterations) * self.box.width
        # cloud drops round the best: En' ~ N(En, He), x ~ N(best, En')
        width = entropy * (1 + 0.1 * self._generator.standard_normal((count, 1)))
        drops = self.best[0] + width * self._generator.standard_normal(self._x.shape)
        mutating = (self._generator.random(count) < self.cloud_settings.p_m) & ~good
        self._x = np.where(mutating[:, None], np.clip(drops, self.box.lower, self.box.upper), self._x)

    def _fitness_ratio(self) -> Array:
        """Return best fitness over each particle's own, shape (population,); 1 where both are 0, 0 where infinite."""
        best, own = self.best[1], self._fitness
        usable = np.isfinite(own) & (own > 0)
        return np.where(usable, best / np.where(usable, own, 1.0) if np.isfinite(best) else 0.0, own == 0)
