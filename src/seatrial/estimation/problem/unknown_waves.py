"""Likelihood of roll in waves of which nothing is known but that they are one sea (Whittle 1953; Brillinger 1981).

Roll's density is W / ((c_1 - w^2)^2 + b_1^2 w^2) and the sensor's noise, W that of the waves' moment per inertia:
slopes of a sea w^-1 exp(-5/4 (w_p / w)^4) gamma^r (Bretschneider 1959; JONSWAP: Hasselmann et al. 1973), felt less
the shorter they are, exp(-w^2 D / g). Level, w_p, gamma, D and the noise are estimated with b_1 and c_1.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.spectral import fine_grid, smeared
from seatrial.numerics.optimise import Normal
from seatrial.physics.simulate.harmonics import Complex

UNKNOWNS = ("level", "w_p", "gamma", "D", "noise", "b_1", "c_1")
DAMPING, RESTORING = 5, 6
_SIGMA = (0.07, 0.09)
_DEPENDENT = 35.0 / 18.0
_STEP = 1e-5
_NO_LOCAL = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class UnknownWaves:
    """Unknowns: logarithms of level, w_p [rad/s], gamma, 1 + D/g [s^2], noise; then of b_1 [1/s], c_1 [1/s^2].

    Attributes:
        omega: (k,), rad/s, evenly spaced; power: |Fourier transform|^2 of roll at them, scaled to a one-sided density.
        centre: rad/s at which the level counts.
    """

    omega: Array
    power: Array
    centre: float

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        c = self.centre
        return np.array([-90.0, np.log(0.3 * c), 0.0, 0.0, -90.0, np.log(2e-3 * c), np.log(0.16 * c**2)])

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        c = self.centre
        return np.array([90.0, np.log(4.0 * c), np.log(10.0), np.log(20.0), 0.0, np.log(2.0 * c), np.log(6.0 * c**2)])

    @cached_property
    def _fine(self) -> Array:
        return np.maximum(fine_grid(self.omega), 1e-2 * self.centre)

    def moment(self, point: Array, omega: Array) -> Array:
        """Density W of the waves' moment per inertia at omega, (n,)."""
        level, w_p, gamma, short = point[0], np.exp(point[1]), point[2], np.exp(point[3]) - 1.0
        sigma = np.where(omega < w_p, *_SIGMA)
        peak = np.exp(-0.5 * ((omega / w_p - 1.0) / sigma) ** 2)
        shape = -np.log(omega / self.centre) - 1.25 * ((w_p / omega) ** 4 - (w_p / self.centre) ** 4)
        return np.exp(level + shape + gamma * peak - short * (omega**2 - self.centre**2))

    def roll(self, point: Array, omega: Array) -> Array:
        """Density of roll without the sensor's noise, (n,)."""
        b, c = np.exp(point[[DAMPING, RESTORING]])
        return self.moment(point, omega) / ((c - omega**2) ** 2 + (b * omega) ** 2)

    def expected(self, point: Array) -> Array:
        """Density as the window shows it at `omega`, (k,)."""
        seen = smeared(_as_matrix(self.roll(point, self._fine)[None]))[0, :, 0, 0]
        return np.asarray(seen.real, dtype=np.float64) + np.exp(point[4])

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        """Minus the logarithm of the likelihood, up to a constant."""
        density = self.expected(shared)
        return float(np.sum(np.log(density) + self.power / density)) / _DEPENDENT

    def normal(self, shared: Array, local: Array) -> Normal:
        """Cost, gradient and Fisher information at a point."""
        density = self.expected(shared)
        steps = _STEP * np.eye(len(shared))
        slopes = np.array([(self.expected(shared + s) - self.expected(shared - s)) for s in steps]) / (2.0 * _STEP)
        relative = slopes / density
        gradient = relative @ (1.0 - self.power / density) / _DEPENDENT
        hessian = relative @ relative.T / _DEPENDENT
        size = len(shared)
        return Normal(
            self.cost(shared, local), gradient, hessian, _NO_LOCAL, np.zeros((0, 0, 0)), np.zeros((0, size, 0))
        )

    def starts(self) -> list[Array]:
        """Points to begin from: roll at, below and above the peak, waves longer and shorter than it."""
        near = np.abs(self.omega / self.centre - 1.0) < 0.1
        level, noise = np.log(np.mean(self.power[near])), np.log(max(np.median(self.power[-20:]), 1e-12))
        made = []
        for ratio in (0.8, 1.0, 1.25):
            c = (ratio * self.centre) ** 2
            b = 0.15 * np.sqrt(c)
            moment = level + np.log((c - self.centre**2) ** 2 + (b * self.centre) ** 2)
            made += [np.array([moment, np.log(w * self.centre), 0.3, 0.2, noise, np.log(b), np.log(c)])
                     for w in (0.75, 1.15)]  # fmt: skip
        return [np.clip(point, self.lower, self.upper) for point in made]

    def between(self, low: float, high: float) -> "UnknownWaves":
        """The same in a band of frequencies."""
        kept = (self.omega >= low) & (self.omega <= high)
        return replace(self, omega=self.omega[kept], power=self.power[kept])


def _as_matrix(density: Array) -> Complex:
    return np.asarray(density[:, :, None, None], dtype=np.complex128)
