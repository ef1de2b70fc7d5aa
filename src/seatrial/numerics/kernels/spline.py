"""The cubic spline through evenly spaced samples: its slopes, of which each piece is made, and points between."""

import numpy as np
from numba import void

from seatrial.numerics.kernels.kernel import LEAN, MATRIX, VECTOR, kernel


@kernel(void(MATRIX, MATRIX, VECTOR), **LEAN)
def _slopes(u, slope, work):
    n = u.shape[0]
    for j in range(u.shape[1]):
        if n < 4:
            rise = 0.0 if n == 1 else (u[n - 1, j] - u[0, j]) / (n - 1)
            bend = 0.0 if n < 3 else u[2, j] - 2.0 * u[1, j] + u[0, j]
            for i in range(n):
                slope[i, j] = rise + (i - 1) * bend
            continue
        before, after = u[1, j] - u[0, j], u[2, j] - u[1, j]
        work[0] = 2.0
        slope[0, j] = 2.5 * before + 0.5 * after  # not-a-knot: s0 + 2 s1 = 5/2 and 1/2 of the first two rises
        for i in range(1, n - 1):
            after = u[i + 1, j] - u[i, j]
            pivot = 1.0 / (4.0 - work[i - 1])
            work[i] = pivot
            slope[i, j] = (3.0 * (before + after) - slope[i - 1, j]) * pivot
            before = after
        last = 2.5 * before + 0.5 * (u[n - 2, j] - u[n - 3, j])  # not-a-knot, as at the first end
        slope[n - 1, j] = (last - 2.0 * slope[n - 2, j]) / (1.0 - 2.0 * work[n - 2])
        for i in range(n - 2, -1, -1):
            slope[i, j] -= work[i] * slope[i + 1, j]


def spline_slopes(u):
    """Return the slope per sample of the not-a-knot cubic spline through u (n, columns), as SciPy's `CubicSpline`.

    Equal steps: s[i-1] + 4 s[i] + s[i+1] = 3 (u[i+1] - u[i-1]) (de Boor 1978, chapter IV). What lies m samples ahead
    acts on a slope by (2 - sqrt 3)^m of its own, so that a few samples ahead do for a whole record.
    """
    slope = np.empty_like(u)
    _slopes(u, slope, np.empty(len(u)))
    return slope


@kernel(void(MATRIX, MATRIX, VECTOR, MATRIX, MATRIX), **LEAN)
def _points(u, slope, place, value, rise):
    last = max(u.shape[0] - 2, 0)
    for k in range(len(place)):
        i = min(int(place[k]), last)
        following, s = min(i + 1, u.shape[0] - 1), place[k] - i
        for j in range(u.shape[1]):
            step = u[following, j] - u[i, j]
            c2 = 3.0 * step - 2.0 * slope[i, j] - slope[following, j]
            c3 = slope[i, j] + slope[following, j] - 2.0 * step
            value[k, j] = u[i, j] + s * (slope[i, j] + s * (c2 + s * c3))
            rise[k, j] = slope[i, j] + s * (2.0 * c2 + s * 3.0 * c3)


def spline_points(u, slope, place):
    """Return the spline through u (n, columns) with these slopes per sample at each place, and its rate per sample.

    place: counted in samples, within 0 and n - 1, (k,). Both results are (k, columns); cubic Hermite pieces (de Boor
    1978, chapter IV, eq. 2).
    """
    value, rise = np.empty((len(place), u.shape[1])), np.empty((len(place), u.shape[1]))
    _points(u, slope, place, value, rise)
    return value, rise
