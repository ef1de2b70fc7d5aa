"""How waves enter a loop: complex amplitudes of what disturbs it, per metre of wave, at a speed and heading."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro.dispersion import G
from seatrial.physics.hydro.excitation import Complex

_ACROSS = 1e-9  # |sin(heading)| and |cos(heading)| that count as none: rounding
_DEEPEST = 18.0  # k T beyond which the energy exp(-k T) that reaches half the draught is below 2e-8; chosen


class WaveEffect(Protocol):
    """What a metre of wave does to a loop: `name` in words, `frequency_range` [rad/s] outside which it does nothing.

    Amplitudes are in quadrature or in phase with the elevation amidships, which only a simulation heeds.
    """

    @property
    def name(self) -> str:
        """Of the effect, in words."""
        ...

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Wave frequencies [rad/s] outside which the effect is negligible, or not known; infinite where it never is."""
        ...

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:
        """Return the amplitude per metre of wave, (n,), at wave frequencies omega [rad/s], U [m/s], beta [rad]."""
        ...


@dataclass(frozen=True)
class WaveSlope:
    """The slope of the waves across the ship [rad], of a point."""

    name = "wave slope across the ship"
    frequency_range = 0.0, math.inf

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:  # noqa: ARG002
        """Return i k |sin(beta)| of each wave, as of `WaveEffect`."""
        return np.asarray(1j * omega**2 / G * _sine_across(beta), dtype=np.complex128)


@dataclass(frozen=True)
class HullFactor:
    """The effective slope [rad]: that of waves averaged over a box of length L, breadth B, draught T [m].

    F = exp(-k T / 2) sinc(k B sin(beta) / 2) sinc(k L cos(beta) / 2), sinc(x) = sin(x) / x: the mean over half the
    draught, the breadth and the length, Froude-Krylov, of a box (Lloyd 1989, Seakeeping, effective wave slope).
    """

    L: float
    B: float
    T: float

    name = WaveSlope.name

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Zero, and the wave frequency [rad/s] whose energy exp(-k T) is below 2e-8."""
        return 0.0, _deepest_frequency(self.T)

    def slope_factor(self, omega: Array, beta: float) -> Array:
        """Return F [-] at wave frequencies omega [rad/s] and heading beta [rad, 0 following]."""
        k = omega**2 / G
        across, along = k * self.B * math.sin(beta) / (2.0 * math.pi), k * self.L * math.cos(beta) / (2.0 * math.pi)
        return np.exp(-k * self.T / 2.0) * np.sinc(across) * np.sinc(along)

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:
        """Return i k |sin(beta)| F of each wave, as of `WaveEffect`."""
        return WaveSlope().amplitude(omega, U, beta) * self.slope_factor(omega, beta)


@dataclass(frozen=True)
class YawAcceleration:
    """The yaw acceleration [rad/s^2] that waves give a hull of length L and draught T [m].

    Every section feels Froude-Krylov and added-mass force of the water's lateral acceleration at half the draught
    (long-wave approximation: Faltinsen 1990, Sea Loads on Ships and Offshore Structures, chapter 3):
    dY/dx = (m' + a') omega^2 a sin(beta) exp(-k T / 2) exp(-i k x cos(beta)). With mass and added mass even along the
    length the moment over the inertia (m' + a') L^3 / 12 is omega^2 k sin(beta) cos(beta) exp(-k T / 2) 3 j1(s) / s,
    s = k L cos(beta) / 2. Sway and what its damping turns into yaw are left out.
    """

    L: float
    T: float

    name = "yaw moment of the waves"

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Zero, and the wave frequency [rad/s] whose energy exp(-k T) is below 2e-8."""
        return 0.0, _deepest_frequency(self.T)

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:  # noqa: ARG002
        """Return the amplitude as of `WaveEffect`, in phase with the slope along the ship."""
        from scipy.special import spherical_jn

        k = omega**2 / G
        across, along = math.sin(beta), math.cos(beta)
        if min(abs(across), abs(along)) < _ACROSS:
            return np.zeros(len(k), dtype=np.complex128)
        s = 0.5 * k * self.L * abs(along)
        # 3 j1(s) / s is one for waves much longer than the hull
        averaged = np.exp(-0.5 * k * self.T) * 3.0 * spherical_jn(1, s) / s
        return np.asarray(-1j * omega**2 * k * across * along * averaged, dtype=np.complex128)


def _sine_across(beta: float) -> float:
    sine = abs(math.sin(beta))
    return sine if sine > _ACROSS else 0.0


def _deepest_frequency(T: float) -> float:
    return math.sqrt(_DEEPEST * G / T)
