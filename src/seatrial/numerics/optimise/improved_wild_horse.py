"""Improved wild horse optimiser of Qi et al. 2025, section 2.2-2.3."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise.ask_tell import Box, SearchError
from seatrial.numerics.optimise.solution import Array
from seatrial.numerics.optimise.wild_horse import HerdSettings, WildHorse


@dataclass(frozen=True)
class ImprovedHerdSettings(HerdSettings):
    """Settings of the improved wild horse optimiser, defaults from Qi et al. 2025, sections 2.2 and 4.1.

    Attributes:
        scatter: probability that a horse is drawn anew in the whole box (eq. 21).
        omega_min, omega_max: limits of the waterhole's weight (eq. 22).
    """

    scatter: float = 0.05
    omega_min: float = 0.1
    omega_max: float = 0.9

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.scatter <= 1:
            raise SearchError(f"The scatter probability lies between 0 and 1, not at {self.scatter}.")


class ImprovedWildHorse(WildHorse):
    """The wild horse optimiser with scattered horses and another law for leaders (eqs. 21-25).

    A scattered leader's point is its trial: it is taken only where it is better, like every move of a leader. The
    fitness in eq. 22 is that of the population of the last iteration; points that could not be evaluated do not enter
    its mean. Eq. 23 draws leaders towards omega WH, that is towards zero: the coordinates of the box matter.
    """

    def __init__(self, box: Box, generator: np.random.Generator, settings: ImprovedHerdSettings | None = None) -> None:
        self.improved_settings = settings or ImprovedHerdSettings()
        super().__init__(box, generator, self.improved_settings)

    def _scatter(self, points: Array) -> Array:
        anew = self._generator.random((len(points), 1)) < self.improved_settings.scatter
        return np.where(anew, self.box.random_points(self._generator, len(points)), points)  # eq. 21

    def _leader_trials(self, z: Array, stride: Array) -> Array:
        waterhole = self.best[0]
        ahead = self._generator.random((len(stride), 1)) >= 0.5
        q1, q2 = self._generator.uniform(-1, 1, (2, len(stride), 1))
        near = stride * (waterhole - self._leaders) + self._waterhole_weights()[:, None] * waterhole  # eq. 23
        rival = waterhole - z * (self._leaders * q1 - self._leaders * q2)  # eq. 24
        return np.where(ahead, near, rival)  # eq. 25

    def _waterhole_weights(self) -> Array:
        """Weight of the waterhole for each leader, eq. 22, shape (groups,)."""
        low, high = self.improved_settings.omega_min, self.improved_settings.omega_max
        own = self._leader_fitness
        known = np.concatenate([own, self._foal_fitness])
        known = known[np.isfinite(known)]
        if not known.size:
            return np.full(len(own), high)
        least, mean = known.min(), known.mean()
        good = own <= mean
        share = np.where(good, own, mean) - least
        return np.where(good, low + (high - low) * share / (mean - least if mean > least else 1.0), high)
