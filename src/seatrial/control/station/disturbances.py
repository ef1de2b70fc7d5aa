"""What drives a craft off its station: water that moves and forces, as spectra for the loop and series in time.

A current carries the craft with the water; waves move a short hull as they move the water, averaged over the hull, and
turn it. Slow drift forces of waves are left out.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from seatrial.control.disturbance_simulation import gauss_markov
from seatrial.control.seaway_simulation import frequency_band, sum_harmonics, wave_components
from seatrial.control.task import Seaway
from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import HullFactor, YawAcceleration

_SLOWEST, _FASTEST, _NODES = 1e-3, 1e4, 300  # frequencies over a bandwidth, and how many; chosen
_BINS, _SEED = 80, 0  # frequencies in which the waves of one sea are gathered, and the seed of these; chosen
AXES = 6
"""Velocity of the water north, east (and none of yaw), then forces X, Y, N: what disturbs a craft."""


@dataclass(frozen=True, eq=False)
class DisturbanceSpectrum:
    """Shares of the cross-covariance of what disturbs, (n, 6, 6), at omega [rad/s], (n,)."""

    omega: Array
    shares: Complex


@dataclass(frozen=True, eq=False)
class DisturbanceSeries:
    """How far the water has gone north and east [m] (2, n), and forces X, Y, N (3, n)."""

    drift: Array
    forces: Array


class StationDisturbance(Protocol):
    """One thing that drives a craft off."""

    @property
    def description(self) -> str:
        """In words."""
        ...

    def spectrum(self) -> DisturbanceSpectrum:
        """Return what it does by frequency."""
        ...

    def series(self, dt: float, count: int, rng: np.random.Generator) -> DisturbanceSeries:
        """Return one realisation of `count` samples."""
        ...


@dataclass(frozen=True)
class SlowPush:
    """Independent Gauss-Markov processes of some of the six axes: rms (6,), bandwidth [rad/s]."""

    description: str
    rms: tuple[float, ...]
    bandwidth: float

    def spectrum(self) -> DisturbanceSpectrum:
        """Return its one-sided density 2 rms^2 b / pi / (w^2 + b^2) (Gelb 1974, section 3.8) on nodes."""
        b = self.bandwidth
        w = np.geomspace(_SLOWEST * b, _FASTEST * b, _NODES)
        energy = 2.0 * b / math.pi / (w**2 + b**2) * np.gradient(w)
        return DisturbanceSpectrum(w, energy[:, None, None] * np.diag(np.square(self.rms)).astype(np.complex128))

    def series(self, dt: float, count: int, rng: np.random.Generator) -> DisturbanceSeries:
        """Return one realisation."""
        made = np.array([rms * gauss_markov(self.bandwidth, dt, count, rng) if rms else np.zeros(count)
                         for rms in self.rms])  # fmt: skip
        return DisturbanceSeries(dt * np.cumsum(made[:2], axis=1), made[3:])


@dataclass(frozen=True)
class WaterSpeed:
    """Horizontal speed of the water of waves along their direction, averaged over a hull [m/s for each m of wave].

    omega times the mean of exp(-k z) over half the draught and of the wave over length and breadth, as `HullFactor`.
    """

    hull: HullFactor

    name = "water that the waves move"

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Wave frequencies [rad/s] that reach the hull."""
        return self.hull.frequency_range

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:  # noqa: ARG002
        """Return the amplitude per metre of wave, in phase with that of `YawAcceleration`."""
        return np.asarray(-1j * omega * self.hull.slope_factor(omega, beta), dtype=np.complex128)


@dataclass(frozen=True, eq=False)
class WavePush:
    """A sea around a craft on station; inertia: M_r by which its yaw acceleration is a moment."""

    sea: Seaway
    hull: HullFactor
    inertia: float

    @property
    def description(self) -> str:
        """In words."""
        return self._still.description

    def spectrum(self) -> DisturbanceSpectrum:
        """Return its waves gathered in bins of frequency."""
        omega, amplitude = self._waves(np.random.default_rng(_SEED))
        edges = np.linspace(omega.min(), omega.max() * (1.0 + 1e-12), _BINS + 1)  # of rounding errors
        place = np.searchsorted(edges, omega, side="right") - 1
        shares = np.zeros((_BINS, AXES, AXES), dtype=np.complex128)
        np.add.at(shares, place, 0.5 * amplitude[:, :, None] * amplitude[:, None, :].conj())
        return DisturbanceSpectrum(0.5 * (edges[1:] + edges[:-1]), shares)

    def series(self, dt: float, count: int, rng: np.random.Generator) -> DisturbanceSeries:
        """Return one realisation."""
        omega, amplitude = self._waves(rng)
        drift = [sum_harmonics(omega, amplitude[:, i] / (1j * omega), dt, count) for i in range(2)]
        moment = sum_harmonics(omega, amplitude[:, AXES - 1], dt, count)
        return DisturbanceSeries(np.array(drift), np.array([np.zeros(count), np.zeros(count), moment]))

    @property
    def _still(self) -> Seaway:
        return replace(self.sea, U=0.0, effect=WaterSpeed(self.hull), path=None, at_points=())

    def _waves(self, rng: np.random.Generator) -> tuple[Array, Complex]:
        """Return frequencies (n,) [rad/s] and complex amplitudes (n, 6) of the waves of one realisation."""
        still = self._still
        lines = wave_components(still, rng, frequency_band(still, np.ones_like))
        made = np.zeros((len(lines.omega), AXES), dtype=np.complex128)
        turning = YawAcceleration(self.hull.L, self.hull.T)
        for beta in np.unique(lines.direction):
            these = lines.direction == beta
            speed = still.effect.amplitude(lines.omega[these], 0.0, float(beta))
            made[these, 0], made[these, 1] = speed * math.cos(beta), speed * math.sin(beta)
            made[these, AXES - 1] = self.inertia * turning.amplitude(lines.omega[these], 0.0, float(beta))
        return lines.omega, made * lines.amplitude[:, None]


def joined(spectra: Sequence[DisturbanceSpectrum]) -> DisturbanceSpectrum:
    """Return independent spectra as one."""
    return DisturbanceSpectrum(
        np.concatenate([one.omega for one in spectra]), np.concatenate([one.shares for one in spectra])
    )


def summed(series: Sequence[DisturbanceSeries], count: int) -> DisturbanceSeries:
    """Return what several disturbances do together."""
    drift, forces = np.zeros((2, count)), np.zeros((3, count))
    for one in series:
        drift, forces = drift + one.drift, forces + one.forces
    return DisturbanceSeries(drift, forces)
