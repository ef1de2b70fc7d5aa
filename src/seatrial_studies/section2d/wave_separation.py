"""The wave that goes on and the one that comes back, from probes along a flume (Mansard & Funke 1980, ICCE)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro import wavenumber

Complex = NDArray[np.complex128]
FREQUENCY_BAND = (0.6, 1.4)
CALIBRATION_BAND = (0.8, 1.2)
RIDGE, TAPER_S = 0.02, 3.0


@dataclass(frozen=True, eq=False)
class Probes:
    """Where wave probes stand and what they must be multiplied by.

    Attributes:
        positions: (p,) m down the flume from the first one.
        gains: (p,) relative to the first one.
        depth: m.
        misfit: share of the calibration records' amplitude that two waves do not explain.
    """

    positions: Array
    gains: Array
    depth: float
    misfit: float = float("nan")


@dataclass(frozen=True, eq=False)
class SeparatedWaves:
    """Elevations at one place: `incident` and `reflected`, shape (n,), m."""

    incident: Array
    reflected: Array


def separate_waves(elevations: Array, dt: float, omega: float, probes: Probes, position: float) -> SeparatedWaves:
    """Two waves at `position` from all probes, frequency by frequency over the whole record, ramps and all.

    At each frequency P_j = A exp(-i k x_j) + B exp(i k x_j) by least squares, a small ridge where probes stand a
    multiple of half a wave length apart; outside `FREQUENCY_BAND` of `omega` nothing is kept.

    Args:
        elevations: (n, p), m, at rest in the beginning.
        position: m down the flume from the first probe.
    """
    spectra, omegas, size = _spectra(elevations, dt)
    chosen = np.flatnonzero((omegas > FREQUENCY_BAND[0] * omega) & (omegas < FREQUENCY_BAND[1] * omega))
    k = wavenumber(omegas[chosen], probes.depth)
    fit, _ = _fit_two_waves(spectra[chosen] * probes.gains, k, probes.positions, RIDGE)
    waves = []
    for column, sign in ((0, -1.0), (1, 1.0)):
        whole = np.zeros(len(omegas), dtype=np.complex128)
        whole[chosen] = fit[:, column] * np.exp(sign * 1j * k * position)
        waves.append(np.fft.irfft(whole, size)[: len(elevations)])
    return SeparatedWaves(waves[0], waves[1])


def calibrate_wave_probes(
    runs: Sequence[tuple[Array, float, float]], depth: float, initial_positions: Sequence[float], ridge: float = 1e-3
) -> Probes:
    """Places and gains relative to the first probe that let two waves explain all runs best.

    Args:
        runs: elevations (n, p), dt, omega of each.
        initial_positions: of the other probes, m from the first; good to a quarter of the shortest wave.

    Raises:
        InputError: no run, or fewer than three probes.
    """
    from scipy.optimize import least_squares

    others = len(initial_positions)
    if not runs or others < 2:
        raise InputError("wave probes are calibrated from at least one run and three probes")
    bands = []
    for elevations, dt, omega in runs:
        spectra, omegas, _ = _spectra(elevations, dt)
        chosen = (omegas > CALIBRATION_BAND[0] * omega) & (omegas < CALIBRATION_BAND[1] * omega)
        bands.append((wavenumber(omegas[chosen], depth), spectra[chosen]))

    def residuals(point: Array) -> Array:
        places, gains = np.array([0.0, *point[:others]]), np.array([1.0, *point[others:]])
        left = [_fit_two_waves(z * gains, k, places, ridge)[1] / np.linalg.norm(z) for k, z in bands]
        return np.concatenate([part.ravel() for e in left for part in (e.real, e.imag)])

    found = least_squares(residuals, [*initial_positions, *([1.0] * others)])
    misfit = float(np.sqrt(np.sum(found.fun**2) / len(bands)))
    return Probes(np.array([0.0, *found.x[:others]]), np.array([1.0, *found.x[others:]]), depth, misfit)


def _spectra(elevations: Array, dt: float) -> tuple[Complex, Array, int]:
    """Spectra (f, p) with the record's end faded out, frequencies [rad/s], length of the transform."""
    count = len(elevations)
    fade = np.ones(count)
    tail = min(count // 4, round(TAPER_S / dt))
    fade[count - tail :] = 0.5 * (1.0 + np.cos(np.pi * np.arange(tail) / tail))
    size = 1 << int(np.ceil(np.log2(count + 1)))
    rest = elevations[: max(1, round(4.0 / dt))].mean(axis=0)
    spectra = np.fft.rfft((elevations - rest) * fade[:, None], size, axis=0)
    omegas = np.asarray(2.0 * np.pi * np.fft.rfftfreq(size, dt), dtype=np.float64)
    return spectra, omegas, size


def _fit_two_waves(spectra: Complex, k: Array, positions: Array, ridge: float) -> tuple[Complex, Complex]:
    """Amplitudes (f, 2) of both waves at the origin, and what they leave (f, p)."""
    phase = np.outer(k, positions)
    basis = np.stack([np.exp(-1j * phase), np.exp(1j * phase)], axis=2)
    adjoint = basis.conj().transpose(0, 2, 1)
    fit = np.linalg.solve(adjoint @ basis + ridge * np.eye(2), adjoint @ spectra[..., None])
    left = (basis @ fit)[..., 0] - spectra
    return fit[..., 0].astype(np.complex128), left.astype(np.complex128)
