"""Arithmetic the checks share: smoothed derivatives, robust size, integrals, jackknifed least squares, stretches."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array

RowIndices = NDArray[np.intp]
Mask = NDArray[np.bool_]
# variance of third differences of white noise over its own: 1 + 9 + 9 + 1
_THIRD_DIFFERENCES = 20.0
# stretches of a record left out in turn; chosen
JACKKNIFE_BLOCKS = 8


def window_length(count: int) -> int:
    """Odd length of the smoothing window: a sixtieth of the record, 11 to 150 samples, at most a quarter of it."""
    # chosen: short against a manoeuvre, in a log of many manoeuvres too
    return max(3, min(max(11, count // 60), 150, count // 4)) | 1


def smoothed(values: Array, length: int) -> Array:
    """Hann-weighted moving average, shape (n - length + 1,)."""
    weights = np.hanning(length + 2)[1:-1]
    return np.asarray(np.convolve(values, weights / weights.sum(), "valid"), dtype=np.float64)


def smoothed_derivative(values: Array, dt: float, length: int) -> Array:
    """Smoothed central differences, on the samples of `smoothed`."""
    return smoothed(np.gradient(values, dt), length)


def trimmed_rms(*components: Array) -> float:
    """Root mean square of a vector's length over the 95 % smallest: a few bad samples do not count."""
    kept = 0.95  # share of the samples; chosen
    squares = np.sum([c**2 for c in components], axis=0)
    count = max(1, int(kept * len(squares)))
    return float(np.sqrt(np.mean(np.partition(squares, count - 1)[:count])))


def cumulative_integral(rate: Array, dt: float) -> Array:
    """Trapezoidal integral from the first sample on, same shape."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1])) * dt])


def sample_noise(values: Array) -> float:
    """Standard deviation of white noise on a signal, from third differences: their variance is 1 + 9 + 9 + 1 times its.

    What does not change within a few samples cancels (Gasser, Sroka & Jennen-Steinmetz 1986, Biometrika 73, 625-633).
    """
    return float(np.sqrt(np.nanmean(np.diff(values, 3) ** 2) / _THIRD_DIFFERENCES)) if len(values) > 3 else 0.0


def least_squares(features: Array, target: Array) -> tuple[Array, float]:
    """Least squares: coefficients and rms of the residual."""
    solution = np.asarray(np.linalg.lstsq(features, target, rcond=None)[0], dtype=np.float64)
    return solution, float(np.sqrt(np.mean((target - features @ solution) ** 2)))


def jackknife_least_squares(features: Array, target: Array) -> tuple[Array, Array]:
    """Least-squares coefficients with standard errors from leaving out one of eight blocks of rows at a time.

    Delete-one-block jackknife (Efron & Tibshirani 1993, eq. 11.5): honest where residuals are autocorrelated.
    """
    edges = np.linspace(0, len(target), JACKKNIFE_BLOCKS + 1).astype(int)
    keep = np.ones(len(target), dtype=bool)
    partial = []
    for first, last in pairwise(edges):
        keep[first:last] = False
        partial.append(least_squares(features[keep], target[keep])[0])
        keep[first:last] = True
    spread = np.array(partial) - np.mean(partial, axis=0)
    errors = np.sqrt((JACKKNIFE_BLOCKS - 1) / JACKKNIFE_BLOCKS * np.sum(spread**2, axis=0))
    return least_squares(features, target)[0], errors


def mask_intervals(mask: Mask) -> list[tuple[int, int]]:
    """First row and row after the last of every unbroken stretch of a mask, in order."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
