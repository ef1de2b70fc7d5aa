"""Likelihood of roll in waves of which nothing is known but that they are one sea (Whittle 1953; Brillinger 1981).

Roll's density is W / ((c_1 - w^2)^2 + b_1^2 w^2) and the sensor's noise, W that of the waves' moment per inertia:
slopes of a sea w^-1 exp(-5/4 (w_p / w)^4) gamma^r (Bretschneider 1959; JONSWAP: Hasselmann et al. 1973), felt less
the shorter they are, exp(-w^2 D / g). Level, w_p, gamma, D and the noise are estimated with b_1 and c_1.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.spectral_likelihood import WINDOW_CORRELATION, apply_leakage, fine_grid
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.linear import Complex

DAMPING, RESTORING = 5, 6  # places among the unknowns
_SIGMA = (0.07, 0.09)  # peak widths of JONSWAP, Hasselmann et al. 1973
_STEP = 1e-5  # of the logarithmic unknowns, for central differences
_NO_LOCAL = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class UnknownWaves:
    """Unknowns: logarithms of level, w_p [rad/s], gamma, 1 + D/g [s^2], noise; then of b_1 [1/s], c_1 [1/s^2].

    Attributes:
        omega: (k,), rad/s, evenly spaced; power: |Fourier transform|^2 of roll at them, scaled to a one-sided density.
        reference_frequency: rad/s at which the level counts.
    """

    omega: Array
    power: Array
    reference_frequency: float

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        c = self.reference_frequency
        # wide bounds of logarithms, in the order of the unknowns; chosen
        return np.array([-90.0, np.log(0.3 * c), 0.0, 0.0, -90.0, np.log(2e-3 * c), np.log(0.16 * c**2)])

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        c = self.reference_frequency
        # wide bounds of logarithms, in the order of the unknowns; chosen
        return np.array([90.0, np.log(4.0 * c), np.log(10.0), np.log(20.0), 0.0, np.log(2.0 * c), np.log(6.0 * c**2)])

    @cached_property
    def _fine_omega(self) -> Array:
        return np.maximum(fine_grid(self.omega), 1e-2 * self.reference_frequency)  # rad/s over the peak, lowest; chosen

    def moment_density(self, point: Array, omega: Array) -> Array:
        """Return the density W of the waves' moment per inertia at omega, (n,)."""
        level, w_p, gamma, short = point[0], np.exp(point[1]), point[2], np.exp(point[3]) - 1.0
        sigma = np.where(omega < w_p, *_SIGMA)
        peak = np.exp(-0.5 * ((omega / w_p - 1.0) / sigma) ** 2)
        shape = -np.log(omega / self.reference_frequency) - 1.25 * (  # exponent of Pierson and Moskowitz 1964
            (w_p / omega) ** 4 - (w_p / self.reference_frequency) ** 4
        )
        return np.exp(level + shape + gamma * peak - short * (omega**2 - self.reference_frequency**2))

    def roll_density(self, point: Array, omega: Array) -> Array:
        """Return the density of roll without the sensor's noise, (n,)."""
        b, c = np.exp(point[[DAMPING, RESTORING]])
        return self.moment_density(point, omega) / ((c - omega**2) ** 2 + (b * omega) ** 2)

    def windowed_density(self, point: Array) -> Array:
        """Return the density as the window shows it at `omega`, (k,)."""
        seen = apply_leakage(_as_matrix(self.roll_density(point, self._fine_omega)[None]))[0, :, 0, 0]
        return np.asarray(seen.real, dtype=np.float64) + np.exp(point[4])

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        """Return the minus the logarithm of the likelihood, up to a constant."""
        density = self.windowed_density(shared)
        return float(np.sum(np.log(density) + self.power / density)) / WINDOW_CORRELATION

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return cost, gradient and Fisher information at a point."""
        density = self.windowed_density(shared)
        steps = _STEP * np.eye(len(shared))
        slopes = np.array([(self.windowed_density(shared + s) - self.windowed_density(shared - s)) for s in steps]) / (
            2.0 * _STEP
        )
        relative = slopes / density
        gradient = relative @ (1.0 - self.power / density) / WINDOW_CORRELATION
        hessian = relative @ relative.T / WINDOW_CORRELATION
        size = len(shared)
        return NormalEquations(
            self.cost(shared, local), gradient, hessian, _NO_LOCAL, np.zeros((0, 0, 0)), np.zeros((0, size, 0))
        )

    def start_points(self) -> list[Array]:
        """Return points to begin from: roll at, below and above the peak, waves longer and shorter than it."""
        near = np.abs(self.omega / self.reference_frequency - 1.0) < 0.1  # band about the peak; chosen
        # last bins, mostly noise; a positive level; chosen
        level, noise = np.log(np.mean(self.power[near])), np.log(max(np.median(self.power[-20:]), 1e-12))
        made = []
        for ratio in (0.8, 1.0, 1.25):  # natural frequencies over that of the peak; chosen
            c = (ratio * self.reference_frequency) ** 2
            b = 0.15 * np.sqrt(c)  # damping to begin from, 2 zeta; chosen
            moment = level + np.log((c - self.reference_frequency**2) ** 2 + (b * self.reference_frequency) ** 2)
            # peak shape and short waves to begin from; chosen
            made += [
                np.array([moment, np.log(w * self.reference_frequency), 0.3, 0.2, noise, np.log(b), np.log(c)])
                for w in (0.75, 1.15)
            ]  # wave peaks over that of the motion; chosen
        return [np.clip(point, self.lower, self.upper) for point in made]

    def band_limited(self, low: float, high: float) -> "UnknownWaves":
        """Return the same in a band of frequencies."""
        kept = (self.omega >= low) & (self.omega <= high)
        return replace(self, omega=self.omega[kept], power=self.power[kept])


def _as_matrix(density: Array) -> Complex:
    return np.asarray(density[:, :, None, None], dtype=np.complex128)
