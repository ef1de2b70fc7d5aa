"""Smoothing and differentiation by polynomials fitted to a moving window (Savitzky & Golay 1964, Anal. Chem. 36, 1627).

As `scipy.signal.savgol_filter` with its default treatment of the ends, bit for bit, without the half second of
processor time that importing `scipy.signal` takes.
"""

from math import factorial

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# variance of a third difference of white noise over its own: 1 + 9 + 9 + 1
_THIRD_DIFFERENCE = 20.0


def white_variance(values: npt.NDArray) -> float:
    """Return the variance of white noise on a signal (n,), real or complex, by its third differences.

    What does not change within a few samples cancels (Gasser, Sroka & Jennen-Steinmetz 1986, Biometrika 73, 625-633).
    0 of fewer than four values, or where no four in a row are finite.
    """
    squares = np.abs(np.diff(values, 3)) ** 2
    return float(np.nanmean(squares)) / _THIRD_DIFFERENCE if np.any(np.isfinite(squares)) else 0.0


def smoothed_locally(values: Array, width: int, degree: int, derivative: int = 0, step: float = 1.0) -> Array:
    """Return a derivative of the local polynomials at every sample, of the shape of `values`.

    values: (n,) or (n, columns), with n >= width. width: samples of the window, odd; within half a width of an end the
    polynomial of the last whole window serves. derivative: its order, 0 for the value. step: between samples, in the
    unit that the derivative is taken by.
    """
    from scipy.ndimage import convolve1d

    half = width // 2
    powers = np.arange(degree + 1, dtype=np.float64)
    wanted = np.zeros(degree + 1)
    wanted[derivative] = factorial(derivative) / step**derivative
    weights = _least_squares(np.arange(half, half - width, -1, dtype=np.float64) ** powers[:, None], wanted)
    result = convolve1d(values, weights, axis=0, mode="constant")
    result[:half] = _fitted(values[:width], degree, derivative, np.arange(half)) / step**derivative
    last = _fitted(values[-width:], degree, derivative, np.arange(width - half, width)) / step**derivative
    result[len(values) - half :] = last
    return result


def _least_squares(matrix: Array, right: Array) -> Array:
    from scipy.linalg import lstsq

    return lstsq(matrix, right, cond=np.finfo(np.float64).eps * max(matrix.shape))[0]


def _fitted(values: Array, degree: int, derivative: int, places: npt.NDArray[np.int64]) -> Array:
    """Return a derivative of the polynomial fitted to all of `values`, by unit step, at these places among them."""
    columns = values.reshape(len(values), -1)
    matrix = np.arange(len(values), dtype=np.float64)[:, None] ** np.arange(degree, -1, -1, dtype=np.float64)
    norms = np.sqrt(np.sum(matrix * matrix, axis=0))
    coefficients = (_least_squares(matrix / norms, columns).T / norms).T  # highest power first
    for _ in range(derivative):
        coefficients = coefficients[:-1] * np.arange(len(coefficients) - 1, 0, -1, dtype=np.float64)[:, None]
    result = np.zeros((len(places), 1))
    for row in coefficients:
        result = result * places[:, None] + row
    return result.reshape(len(places), *values.shape[1:])
