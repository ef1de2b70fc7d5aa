"""Particle swarm with inertia weights and mutations from a normal cloud (ICPSO, Meng et al. 2014).

Its parent, the cloud particle swarm of Wei et al. 2009, is left out: no source that prints its law could be found.
"""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise.ask_tell import Box, SearchError
from seatrial.numerics.optimise.particle_swarm import ParticleSwarm, SwarmSettings
from seatrial.numerics.optimise.solution import Array


@dataclass(frozen=True)
class CloudSettings(SwarmSettings):
    """Settings of the cloud particle swarm, as Meng et al. 2014 print them below eqs. 6 and 7.

    `omega` is not used. The velocity limit and the spread of the mutation are not printed; ours.

    Attributes:
        w1, w2: largest and smallest inertia weight.
        a, b: thresholds on the best fitness over a particle's own, between bad and middling, middling and good.
        entropy, hyper_entropy: En and He of the weight's cloud; its expectation is Ex = 5 w1 - w2.
        mutation: probability that a particle which is not good becomes a drop of the cloud round the best.
        spread: En of that cloud as a share of the box's width, at the start; it shrinks linearly to zero.
    """

    population: int = 60
    iterations: int = 1000
    c1: float = 2.05
    c2: float = 2.05
    velocity_limit: float = 0.2
    w1: float = 0.9
    w2: float = 0.4
    a: float = 0.15
    b: float = 0.93
    entropy: float = 5.0
    hyper_entropy: float = 0.5
    mutation: float = 0.2
    spread: float = 0.1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.mutation <= 1:
            raise SearchError(f"The mutation probability lies between 0 and 1, not at {self.mutation}.")
        if not self.a <= self.b:
            raise SearchError(f"Threshold a = {self.a} must not exceed threshold b = {self.b}.")
        for name, value in (("hyper_entropy", self.hyper_entropy), ("spread", self.spread)):
            if value < 0:
                raise SearchError(f"Setting {name} is the width of a normal law, not {value}; give 0 or more.")


class CloudParticleSwarm(ParticleSwarm):
    """Meng et al. 2014, eqs. 4-6, completed where the print is illegible.

    Eq. 4 prints no inertia weight though eq. 6 sets it: it multiplies the velocity. Of eq. 6 only the constants are
    left; its form is that of the normal cloud in their reference to Wei et al. 2009. Which particles mutate, and with
    which cloud, is lost: ours are those whose ratio does not exceed b, spread as in the settings with He = En / 10.
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
        entropy = self._generator.normal(c.entropy, c.hyper_entropy, len(ratio))
        away = (ratio - (5 * c.w1 - c.w2)) / np.where(entropy == 0.0, np.finfo(float).tiny, entropy)
        cloud = c.w1 - (c.w1 - c.w2) * np.exp(-0.5 * away**2)
        return np.where(ratio > c.b, c.w2, np.where(ratio < c.a, c.w1, cloud))[:, None]

    def _move(self) -> None:
        good = self._fitness_ratio() > self.cloud_settings.b
        super()._move()
        count = len(self._x)
        entropy = self.cloud_settings.spread * (1 - self.iteration / self.iterations) * self.box.width
        # cloud drops round the best: En' ~ N(En, He), x ~ N(best, En')
        width = entropy * (1 + 0.1 * self._generator.standard_normal((count, 1)))
        drops = self.best[0] + width * self._generator.standard_normal(self._x.shape)
        mutating = (self._generator.random(count) < self.cloud_settings.mutation) & ~good
        self._x = np.where(mutating[:, None], np.clip(drops, self.box.lower, self.box.upper), self._x)

    def _fitness_ratio(self) -> Array:
        """Best fitness over each particle's own, shape (population,); 1 where both are 0, 0 where infinite."""
        best, own = self.best[1], self._fitness
        usable = np.isfinite(own) & (own > 0)
        return np.where(usable, best / np.where(usable, own, 1.0) if np.isfinite(best) else 0.0, own == 0)
