"""Linear models: exact propagators over one step (Higham 2008, section 10.7), and runs by them, with sensitivities."""

import math

import numpy as np
from numba import njit, void

from seatrial.numerics.kernels.integrate import DIVERGED
from seatrial.numerics.kernels.kernel import (
    CUBE,
    F8,
    I8,
    INDEX,
    LEAN,
    MATRIX,
    OPTIONS,
    QUARTIC,
    TABLE,
    TANGENT,
    VECTOR,
    kernel,
)

# Exact propagators of x' = A x + B u over one step, with their derivatives (Higham 2008, section 10.7).

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


# Linear models: their matrices from the generated code, and their runs by exact propagators, with sensitivities.


@kernel(void(TANGENT, I8, I8, INDEX, VECTOR, MATRIX, CUBE, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX), **LEAN)
def _affine_matrices(f, nx, nu, parameter_index, p, value, slope, x, u, out, jac, slope_at_origin):
    rows = value.shape[0]
    for i in range(nx):
        x[i] = 0.0
    for j in range(nu):
        u[j] = 0.0
    f(0.0, x, u, p, out, jac)
    for i in range(rows):
        for k in range(nx + nu):
            value[i, k] = jac[i, k]
        value[i, nx + nu] = out[i]
        for q in range(parameter_index.size):
            slope_at_origin[i, q] = jac[i, nx + nu + parameter_index[q]]
            slope[q, i, nx + nu] = slope_at_origin[i, q]
    for k in range(nx + nu):
        if k < nx:
            x[k] = 1.0
        else:
            u[k - nx] = 1.0
        f(0.0, x, u, p, out, jac)
        for i in range(rows):
            for q in range(parameter_index.size):
                slope[q, i, k] = jac[i, nx + nu + parameter_index[q]] - slope_at_origin[i, q]
        if k < nx:
            x[k] = 0.0
        else:
            u[k - nx] = 0.0


def affine_matrices(f, rows, nx, nu, parameter_index, p):
    """Return [A | B | c] of an affine function, (rows, nx + nu + 1), and its slopes by some parameters, (k, ...).

    f: a function with its Jacobian, columns [x | u | p]. As f is affine in x and u at fixed p, its slope by a parameter
    at a unit vector less that at the origin is the derivative of that vector's column: exact.
    """
    width = nx + nu
    value, slope = np.zeros((rows, width + 1)), np.zeros((len(parameter_index), rows, width + 1))
    if rows:
        scratch = np.empty(nx), np.empty(max(nu, 1)), np.empty(rows), np.zeros((rows, width + len(p)))
        origin = np.empty((rows, max(len(parameter_index), 1)))
        _affine_matrices(f, nx, nu, parameter_index, p, value, slope, *scratch, origin)
    return value, slope


@kernel(void(TANGENT, I8, I8, MATRIX, CUBE, VECTOR, VECTOR, VECTOR, MATRIX), **LEAN)
def _affine_population(f, nx, nu, p, value, x, u, out, jac):
    for c in range(p.shape[0]):
        f(0.0, x, u, p[c], out, jac)
        for i in range(nx):
            for k in range(nx + nu):
                value[c, i, k] = jac[i, k]
            value[c, i, nx + nu] = out[i]


def affine_population(f, nx, nu, p):
    """Return the matrices [A | B | c] of an affine function's rates at each row of parameters p (count, parameters).

    f: as in `affine_matrices`. Returns (count, nx, nx + nu + 1).
    """
    value = np.empty((len(p), nx, nx + nu + 1))
    scratch = np.zeros(nx), np.zeros(max(nu, 1)), np.empty(nx), np.zeros((nx, nx + nu + p.shape[1]))
    _affine_population(f, nx, nu, np.ascontiguousarray(p), value, *scratch)
    return value


@njit(inline="always", **OPTIONS)
def advance(e, g0, g1, x, u0, u1, y):
    """Set x to e x + g0 u0 + g1 u1 and return its size; y is scratch."""
    n = x.size
    size = 0.0
    for i in range(n):
        total = 0.0
        for k in range(n):
            total += e[i, k] * x[k]
        for j in range(u0.size):
            total += g0[i, j] * u0[j] + g1[i, j] * u1[j]
        y[i] = total
    for i in range(n):
        x[i] = y[i]
        size += abs(y[i])
    return size


@njit(inline="always", **OPTIONS)
def _observe(c, d, x, u, out):
    for i in range(out.size):
        total = 0.0
        for k in range(x.size):
            total += c[i, k] * x[k]
        for j in range(u.size):
            total += d[i, j] * u[j]
        out[i] = total


@kernel(void(CUBE, CUBE, CUBE, CUBE, CUBE, INDEX, MATRIX, INDEX, I8, MATRIX, MATRIX, INDEX, VECTOR, VECTOR), **LEAN)
def _replay(e, g0, g1, c, d, matrix_index, inputs, offsets, substeps, x0, y_out, failed, x, y):
    for s in range(offsets.size - 1):
        first, last, w = offsets[s], offsets[s + 1], matrix_index[s]
        for i in range(x.size):
            x[i] = x0[s, i]
        row = (first - offsets[0]) * substeps - s * (substeps - 1)
        for k in range(first, last):
            _observe(c[w], d[w], x, inputs[row], y_out[k])
            if k == last - 1:
                break
            size = 0.0
            for _ in range(substeps):
                size = advance(e[w], g0[w], g1[w], x, inputs[row], inputs[row + 1], y)
                row += 1
            if not size < DIVERGED:
                failed[s] = k + 1 - first
                for late in range(k + 1, last):
                    for i in range(y_out.shape[1]):
                        y_out[late, i] = math.nan
                break


def replay(e, g0, g1, c, d, matrix_index, inputs, offsets, substeps, x0, y_out, failed):
    """Integrate segments whose matrices are e[matrix_index[s]], ...; write y at every sample.

    Segment s owns rows offsets[s]..offsets[s+1] of y_out. `inputs` holds `substeps` rows to a sample (its last sample
    one), segments end to end, the constant 1 as the last column.
    failed[s] becomes the sample at which the solution left all bounds (or was not finite), else stays -1.
    """
    nx = x0.shape[1]
    _replay(e, g0, g1, c, d, matrix_index, inputs, offsets, substeps, x0, y_out, failed, np.empty(nx), np.empty(nx))


@kernel(
    void(
        *(CUBE, CUBE, CUBE, CUBE, CUBE, QUARTIC, QUARTIC, QUARTIC, QUARTIC, QUARTIC, INDEX, MATRIX, INDEX, I8),
        *(MATRIX, TABLE, MATRIX, INDEX, MATRIX, CUBE, INDEX, VECTOR, VECTOR, MATRIX, MATRIX),
    ),
    **LEAN,
)
def _replay_tangent(
    e, g0, g1, c, d, de, dg0, dg1, dc, dd, matrix_index, inputs, offsets, substeps,
    x0, correction_columns, weights, start_column, y_out, s_out, failed, x, y, s, t,
):  # fmt: skip
    nx, nu, ncol, count = x.size, inputs.shape[1], s.shape[1], de.shape[3]
    for seg in range(offsets.size - 1):
        first, last, w = offsets[seg], offsets[seg + 1], matrix_index[seg]
        ew, g0w, g1w, cw, dw = e[w], g0[w], g1[w], c[w], d[w]
        dew, dg0w, dg1w, dcw, ddw = de[w], dg0[w], dg1[w], dc[w], dd[w]
        for i in range(nx):
            x[i] = x0[seg, i]
            for q in range(ncol):
                s[i, q] = 0.0
            if start_column[i] >= 0:
                s[i, start_column[i]] = 1.0
        row = (first - offsets[0]) * substeps - seg * (substeps - 1)
        for k in range(first, last):
            _observe(cw, dw, x, inputs[row], y_out[k])
            for i in range(y_out.shape[1]):
                for q in range(ncol):
                    s_out[k, i, q] = 0.0
                for m in range(nx):
                    a = cw[i, m]
                    if a != 0.0:
                        for q in range(ncol):
                            s_out[k, i, q] += a * s[m, q]
                    for q in range(count):
                        s_out[k, i, q] += dcw[i, m, q] * x[m]
                for j in range(nu):
                    for q in range(count):
                        s_out[k, i, q] += ddw[i, j, q] * inputs[row, j]
                for q in range(correction_columns.shape[0]):
                    s_out[k, i, correction_columns[q, 1]] += dw[i, correction_columns[q, 0]] * weights[row, q]
            if k == last - 1:
                break
            size = 0.0
            for _ in range(substeps):
                for i in range(nx):
                    for q in range(ncol):
                        t[i, q] = 0.0
                    for m in range(nx):
                        a = ew[i, m]
                        for q in range(ncol):
                            t[i, q] += a * s[m, q]
                        b = x[m]
                        for q in range(count):
                            t[i, q] += b * dew[i, m, q]
                    for j in range(nu):
                        b0, b1 = inputs[row, j], inputs[row + 1, j]
                        for q in range(count):
                            t[i, q] += b0 * dg0w[i, j, q] + b1 * dg1w[i, j, q]
                    for q in range(correction_columns.shape[0]):
                        j = correction_columns[q, 0]
                        t[i, correction_columns[q, 1]] += g0w[i, j] * weights[row, q] + g1w[i, j] * weights[row + 1, q]
                for i in range(nx):
                    for q in range(ncol):
                        s[i, q] = t[i, q]
                size = advance(ew, g0w, g1w, x, inputs[row], inputs[row + 1], y)
                row += 1
            if not size < DIVERGED:
                failed[seg] = k + 1 - first
                for late in range(k + 1, last):
                    for i in range(y_out.shape[1]):
                        y_out[late, i] = math.nan
                break


def replay_tangent(
    e, g0, g1, c, d, de, dg0, dg1, dc, dd, matrix_index, inputs, offsets, substeps, x0, correction_columns, weights,
    start_column, y_out, s_out, failed
):  # fmt: skip
    """Integrate with sensitivities: columns of parameters (last axis of de, ...), of input corrections, of starts.

    correction_columns: (corrections, 2), input column and sensitivity column of each; weights: (fine rows,
    corrections), derivative of that input by its correction. start_column: (nx,), of each initial state, or -1.
    """
    nx, ncol = x0.shape[1], s_out.shape[2]
    _replay_tangent(
        e, g0, g1, c, d, de, dg0, dg1, dc, dd, matrix_index, inputs, offsets, substeps, x0, correction_columns, weights,
        start_column, y_out, s_out, failed, np.empty(nx), np.empty(nx), np.empty((nx, ncol)), np.empty((nx, ncol)),
    )  # fmt: skip
