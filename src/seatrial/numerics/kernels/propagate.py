"""Exact propagators of x' = A x + B u over one step, with their derivatives (Higham 2008, section 10.7).

E = exp(A h); the response to a held input is P B, that to a ramp from 0 to 1 over the step R B:
P = h phi_1(A h), R = h phi_2(A h) with phi_1(z) = (e^z - 1)/z, phi_2(z) = (e^z - 1 - z)/z^2.
Taylor series of the scaled matrix, then doubling: e^2z = (e^z)^2, phi_1(2z) = (e^z + 1) phi_1(z)/2,
phi_2(2z) = (e^z phi_2(z) + phi_1(z) + phi_2(z))/4, each differentiated as it stands.
"""

import math

import numpy as np
from numba import njit, void

from seatrial.numerics.kernels.kernel import CUBE, F8, LEAN, MATRIX, OPTIONS, QUARTIC, kernel

# norm to which A h is halved, terms of the series there (the next is 0.25^12 / 12! = 1e-16, rounding), and halvings
# after which a matrix counts as too large; chosen
SERIES_NORM, SERIES_TERMS, MAX_HALVINGS = 0.25, 11, 60


@njit(inline="always", **OPTIONS)
def _add_product(a, b, factor, out):
    """Add factor a b to out."""
    n = out.shape[0]
    for i in range(n):
        for k in range(n):
            scaled = factor * a[i, k]
            for j in range(n):
                out[i, j] += scaled * b[k, j]


@njit(inline="always", **OPTIONS)
def _fill(a, value):
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            a[i, j] = value


@njit(inline="always", **OPTIONS)
def _count_halvings(a, h):
    size = 0.0
    for i in range(a.shape[0]):
        row = 0.0
        for j in range(a.shape[0]):
            row += abs(a[i, j])
        size = max(size, row)
    size *= h
    count = 0
    while size > SERIES_NORM and count < MAX_HALVINGS:
        size *= 0.5
        count += 1
    return count


@njit(inline="always", **OPTIONS)
def _double_derivatives(value, slope, one, two, three):
    """Double the step of the derivatives in place; `value` is still that over one."""
    n = one.shape[0]
    _fill(one, 0.0)
    _fill(two, 0.0)
    _fill(three, 0.0)
    _add_product(slope[0], value[2], 1.0, one)
    _add_product(value[0], slope[2], 1.0, one)
    _add_product(slope[0], value[1], 1.0, two)
    _add_product(value[0], slope[1], 1.0, two)
    _add_product(slope[0], value[0], 1.0, three)
    _add_product(value[0], slope[0], 1.0, three)
    for i in range(n):
        for j in range(n):
            slope[2, i, j] = 0.25 * (one[i, j] + slope[1, i, j] + slope[2, i, j])
            slope[1, i, j] = 0.5 * (two[i, j] + slope[1, i, j])
            slope[0, i, j] = three[i, j]


@kernel(void(MATRIX, CUBE, F8, CUBE, QUARTIC, CUBE, CUBE), **LEAN)
def _propagators(a, da, h, value, slope, power, dpower):
    n, count = a.shape[0], da.shape[0]
    halvings = _count_halvings(a, h)
    if halvings >= MAX_HALVINGS:
        for m in range(3):
            _fill(value[m], math.nan)
            for q in range(count):
                _fill(slope[q, m], math.nan)
        return
    step = h * 0.5**halvings
    term, following = power[0], power[1]
    _fill(term, 0.0)
    for m in range(3):
        _fill(value[m], 0.0)
    for i in range(n):
        term[i, i] = 1.0
        value[0, i, i], value[1, i, i], value[2, i, i] = 1.0, 1.0, 0.5
    for q in range(count):
        _fill(dpower[q], 0.0)
        for m in range(3):
            _fill(slope[q, m], 0.0)
    for k in range(1, SERIES_TERMS + 1):
        first, second = 1.0 / (k + 1), 1.0 / ((k + 1) * (k + 2))
        for q in range(count):
            _fill(following, 0.0)
            _add_product(dpower[q], a, step / k, following)
            _add_product(term, da[q], step / k, following)
            for i in range(n):
                for j in range(n):
                    d = following[i, j]
                    dpower[q, i, j] = d
                    slope[q, 0, i, j] += d
                    slope[q, 1, i, j] += d * first
                    slope[q, 2, i, j] += d * second
        _fill(following, 0.0)
        _add_product(term, a, step / k, following)
        for i in range(n):
            for j in range(n):
                d = following[i, j]
                term[i, j] = d
                value[0, i, j] += d
                value[1, i, j] += d * first
                value[2, i, j] += d * second
    for _ in range(halvings):
        for q in range(count):
            _double_derivatives(value, slope[q], dpower[q], term, following)
        _fill(term, 0.0)
        _fill(following, 0.0)
        _add_product(value[0], value[2], 1.0, term)
        _add_product(value[0], value[1], 1.0, following)
        for i in range(n):
            for j in range(n):
                value[2, i, j] = 0.25 * (term[i, j] + value[1, i, j] + value[2, i, j])
        for i in range(n):
            for j in range(n):
                value[1, i, j] = 0.5 * (following[i, j] + value[1, i, j])
        _fill(term, 0.0)
        _add_product(value[0], value[0], 1.0, term)
        for i in range(n):
            for j in range(n):
                value[0, i, j] = term[i, j]
    for i in range(n):
        for j in range(n):
            for m in range(1, 3):
                value[m, i, j] *= h
                for q in range(count):
                    slope[q, m, i, j] *= h


def propagators(a, da, h):
    """Return E, P, R stacked as (3, n, n), and their derivatives (count, 3, n, n) along `da` (count, n, n).

    a: (n, n), 1/s; h: step, s. NaN where a is too large to be scaled.
    """
    count, n = da.shape[0], a.shape[0]
    value, slope = np.empty((3, n, n)), np.empty((count, 3, n, n))
    _propagators(a, da, h, value, slope, np.empty((2, n, n)), np.empty((count, n, n)))
    return value, slope
