"""Peaks of residual spectra: at which frequencies some channels swing, and by how much, above what lies beside."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Index

_SEGMENT_LENGTHS = (64, 1024)
"""Samples of the stretches that are averaged, at least and at most; chosen."""
_AVERAGES = 4  # stretches in all samples, which overlap by half; chosen
_ASIDE = 1.7  # factor between a peak and the places to both sides that it is compared with; chosen
_SMOOTHED = 3  # neighbouring frequencies that are averaged; chosen
_LEAST_EXCESS = float(np.log(2.0))  # of a peak over the power law through both sides; chosen: slopes' knees reach 0.4
_HIGH_EXCESS = float(np.log(8.0))  # of a peak that is waves beyond doubt; chosen
_SHARED_EXCESS = float(np.log(1.25))  # of the other channels there, whose noise hides more; chosen
_APART = 1.2  # least factor between two peaks; chosen
_BAND = 1.4  # factor to both sides of a peak within which its variance lies; chosen


@dataclass(frozen=True, eq=False)
class SpectralPeak:
    """A frequency [rad/s] at which spectra peak.

    Attributes:
        variance: of each channel in its band, above what lies beside, (ny,), 0 where it does not peak there.
        floor: variance of white noise with the least density of each channel's spectrum, (ny,).
        is_high: whether a channel exceeds its sides there as nothing but waves does.
    """

    frequency: float
    variance: Array
    floor: Array
    is_high: bool = False


def spectral_peaks(pieces: Sequence[Array], dt: float, most: int) -> list[SpectralPeak]:
    """Return the highest peaks of the spectra of residuals, at most so many, the one that exceeds its sides most first.

    Excess is the logarithm of density over the geometric mean of those at 1.7 times and at 1 / 1.7 of the frequency:
    nothing for any power law, below zero where white noise takes over from one.

    Args:
        pieces: residuals of runs, (rows, ny) each, NaN where nothing was measured; dt: time step [s].
    """
    omega, density = _density(pieces, dt)
    if len(omega) < 2 * _SMOOTHED:
        return []
    excess = _excess(omega, density)
    peaks: list[SpectralPeak] = []
    for place in _local_maxima(np.max(excess, axis=1)):
        frequency = float(omega[place])
        if all(max(frequency / p.frequency, p.frequency / frequency) > _APART for p in peaks):
            peaks.append(_peak(omega, density, excess, place))
    return peaks[:most]


def _density(pieces: Sequence[Array], dt: float) -> tuple[Array, Array]:
    """Frequencies [rad/s] and densities per rad/s, (frequencies, ny), averaged over overlapping stretches (Welch)."""
    from scipy.signal import welch

    rows = sum(len(p) for p in pieces)
    longest = max(len(p) for p in pieces)
    shortest, most = _SEGMENT_LENGTHS
    length = int(np.clip(2 ** int(np.log2(max(rows // _AVERAGES, 1))), shortest, most))
    length = min(length, longest)
    long_enough = [p for p in pieces if len(p) >= length]
    spectra = [
        np.asarray(welch(np.nan_to_num(p), 1.0 / dt, nperseg=length, detrend=_without_trend, axis=0)[1])
        for p in long_enough
    ]
    density = np.average(spectra, axis=0, weights=[len(p) for p in long_enough])
    omega = np.asarray(2.0 * np.pi * np.fft.rfftfreq(length, dt), dtype=np.float64)
    return omega[1:], density[1:] / (2.0 * np.pi)


def _without_trend(values: Array) -> Array:
    """Return values without the straight line through them, along the last axis."""
    from scipy.signal import detrend

    return np.asarray(detrend(values))


def _excess(omega: Array, density: Array) -> Array:
    """Logarithm of the smoothed densities over what a power law through both sides has, (frequencies, ny)."""
    kernel = np.ones(_SMOOTHED) / _SMOOTHED
    padded = np.pad(density, ((_SMOOTHED // 2, _SMOOTHED // 2), (0, 0)), mode="edge")
    smooth = np.stack([np.convolve(column, kernel, "valid") for column in padded.T], axis=1)
    log = np.log(np.maximum(smooth, np.finfo(float).tiny))
    sides = [np.stack([np.interp(omega * f, omega, c) for c in log.T], axis=1) for f in (_ASIDE, 1.0 / _ASIDE)]
    return log - 0.5 * (sides[0] + sides[1])


def _local_maxima(values: Array) -> Index:
    """Places of local maxima with enough excess, the largest first."""
    padded = np.pad(values, 1, constant_values=-np.inf)
    is_peak = (values >= padded[:-2]) & (values >= padded[2:]) & (values >= _LEAST_EXCESS)
    places = np.flatnonzero(is_peak)
    return places[np.argsort(-values[places], kind="stable")]


def _peak(omega: Array, density: Array, excess: Array, place: int) -> SpectralPeak:
    frequency, step = omega[place], omega[1] - omega[0]
    is_inside = (omega > frequency / _BAND) & (omega < frequency * _BAND)
    edges = np.searchsorted(omega, [frequency / _BAND, frequency * _BAND]).clip(0, len(omega) - 1)
    beside = np.min(density[edges], axis=0)
    variance = step * np.sum(np.maximum(density[is_inside] - beside, 0.0), axis=0)
    near = slice(max(place - 1, 0), place + 2)
    variance = np.where(np.max(excess[near], axis=0) >= _SHARED_EXCESS, variance, 0.0)
    is_high = bool(np.max(excess[near]) >= _HIGH_EXCESS)
    return SpectralPeak(float(frequency), variance, np.min(density, axis=0) * float(omega[-1]), is_high)
