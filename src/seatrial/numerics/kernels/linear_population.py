"""Whole populations of small linear models at once: one candidate in each lane of a vector register.

x' = A x + B u, each candidate with its own A and B, all with the same inputs. A lane is scaled and squared by its own
numbers only, and blocks are always full: a candidate's bits do not depend on its neighbours.

Inputs held over a step: Phi = e^{A h}, Gamma = h phi_1(A h) B, v_k = u_k. Inputs straight between samples: Gamma =
[G0 | G1], G1 = h phi_2(A h) B, G0 = h phi_1(A h) B - G1, v_k = [u_k | u_{k+1}] (Van Loan 1978, theorem 1; series and
doubling as in `propagate`, applied to B). Either way x_{k+1} = Phi x_k + Gamma v_k.
"""

import math

from numba import njit, void

from seatrial.numerics.kernels.kernel import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, VECTOR, kernel
from seatrial.numerics.kernels.linear import MAX_HALVINGS, SERIES_NORM, SERIES_TERMS
from seatrial.numerics.kernels.simd import (
    LANES,
    add_squared_difference,
    aligned_scratch,
    broadcast,
    copy_where_greater,
    dot,
)


@njit(inline="always", **OPTIONS)
def _product(w, a, b, out, rows, inner, columns):
    """Set out = a b, matrices of slots row by row."""
    for i in range(rows):
        for j in range(columns):
            dot(w, out + i * columns + j, a + i * inner, b + j, columns, inner)


@njit(inline="always", **OPTIONS)
def _scale(w, nx, h, at_a, halvings):
    """Scale A to A h / 2^n, n the halvings of each lane until it is small, NaN if too large; return the most."""
    most = 0
    for lane in range(LANES):
        size = 0.0
        for i in range(nx):
            row = 0.0
            for j in range(nx):
                row += abs(w[(at_a + i * nx + j) * LANES + lane])
            size = max(size, row)
        size *= abs(h)
        count, step = 0, h
        while size > SERIES_NORM and count < MAX_HALVINGS:
            size *= 0.5
            step *= 0.5
            count += 1
        if count == MAX_HALVINGS:
            count, step = 0, math.nan
        for m in range(nx * nx):
            w[(at_a + m) * LANES + lane] *= step
        w[halvings * LANES + lane] = count
        most = max(most, count)
    return most


@njit(inline="always", **OPTIONS)
def _discretise_blocks(a, b, h, phi, gamma, w, nx, nu):
    nv = gamma.shape[2]
    nn, nb = nx * nx, nx * nu
    e, at_a, power, square = 0, nn, 2 * nn, 3 * nn
    p, r, power_b, held, slope = 4 * nn, 4 * nn + nb, 4 * nn + 2 * nb, 4 * nn + 3 * nb, 4 * nn + 4 * nb
    halvings = slope + nb
    for first in range(0, a.shape[0], LANES):
        for lane in range(LANES):
            c = min(first + lane, a.shape[0] - 1)
            for i in range(nx):
                for j in range(nx):
                    unit = 1.0 if i == j else 0.0
                    w[(at_a + i * nx + j) * LANES + lane] = a[c, i, j]
                    w[(e + i * nx + j) * LANES + lane] = unit
                    w[(power + i * nx + j) * LANES + lane] = unit
                for j in range(nu):
                    scaled = h * b[c, i, j]
                    w[(p + i * nu + j) * LANES + lane] = scaled
                    w[(r + i * nu + j) * LANES + lane] = 0.5 * scaled
                    w[(power_b + i * nu + j) * LANES + lane] = scaled
        most = _scale(w, nx, h, at_a, halvings)
        for k in range(1, SERIES_TERMS + 1):
            _product(w, power, at_a, square, nx, nx, nx)
            _product(w, at_a, power_b, held, nx, nx, nu)
            over, after, later = 1.0 / k, 1.0 / (k + 1), 1.0 / ((k + 1) * (k + 2))
            for m in range(nn * LANES):
                d = over * w[square * LANES + m]
                w[power * LANES + m] = d
                w[e * LANES + m] += d
            for m in range(nb * LANES):
                d = over * w[held * LANES + m]
                w[power_b * LANES + m] = d
                w[p * LANES + m] += after * d
                w[r * LANES + m] += later * d
        for done in range(most):
            _product(w, e, e, square, nx, nx, nx)
            _product(w, e, p, held, nx, nx, nu)
            _product(w, e, r, slope, nx, nx, nu)
            for m in range(nb * LANES):
                w[slope * LANES + m] = 0.25 * (w[slope * LANES + m] + w[p * LANES + m] + w[r * LANES + m])
                w[held * LANES + m] = 0.5 * (w[held * LANES + m] + w[p * LANES + m])
            for m in range(nb):
                copy_where_greater(w, r + m, slope + m, halvings, done)
                copy_where_greater(w, p + m, held + m, halvings, done)
            for m in range(nn):
                copy_where_greater(w, e + m, square + m, halvings, done)
        for lane in range(min(LANES, a.shape[0] - first)):
            for i in range(nx):
                for j in range(nx):
                    phi[first + lane, i, j] = w[(e + i * nx + j) * LANES + lane]
                for j in range(nu):
                    whole, late = w[(p + i * nu + j) * LANES + lane], w[(r + i * nu + j) * LANES + lane]
                    if nv > nu:
                        gamma[first + lane, i, j], gamma[first + lane, i, nu + j] = whole - late, late
                    else:
                        gamma[first + lane, i, j] = whole


@kernel(void(CUBE, CUBE, F8, CUBE, CUBE, VECTOR), **LEAN)
def _discretise(a, b, h, phi, gamma, w):
    if a.shape[1] == 4 and b.shape[2] == 2:  # heave and pitch: constants let loops be taken apart, twice as fast
        _discretise_blocks(a, b, h, phi, gamma, w, 4, 2)
    else:
        _discretise_blocks(a, b, h, phi, gamma, w, a.shape[1], b.shape[2])


def discretise(a, b, h, phi, gamma):
    """Fill phi (count, nx, nx) and gamma (count, nx, nu), inputs held, or (count, nx, 2 nu), inputs straight.

    a: (count, nx, nx), 1/s; b: (count, nx, nu); h: step, s. NaN where a matrix is not finite or too large to be scaled.
    """
    nx, nu = a.shape[1], b.shape[2]
    # slots: four matrices of A's size, five of B's, the halvings
    _discretise(a, b, h, phi, gamma, aligned_scratch(4 * nx * nx + 5 * nx * nu + 1))


@njit(inline="always", **OPTIONS)
def _load(w, phi, gamma, x0, first, nx, nv):
    """Fill slots: rows [Gamma | Phi], then [v | x]; return where [v | x] begins."""
    width = nv + nx
    for lane in range(LANES):
        c = min(first + lane, phi.shape[0] - 1)
        for i in range(nx):
            for j in range(nv):
                w[(i * width + j) * LANES + lane] = gamma[c, i, j]
            for j in range(nx):
                w[(i * width + nv + j) * LANES + lane] = phi[c, i, j]
            w[(nx * width + nv + i) * LANES + lane] = x0[c, i]
    return nx * width


@njit(inline="always", **OPTIONS)
def _step(w, v, k, nx, nv, here):
    """Advance the state beside `here` to that beside the place returned, the other one of two."""
    width = nv + nx
    there = nx * width if here > nx * width else nx * width + width
    for j in range(nv):
        broadcast(w, here + j, v[k, j])
    for i in range(nx):
        dot(w, there + nv + i, i * width, here, 1, width)
    return there


@kernel(void(CUBE, CUBE, MATRIX, I8, MATRIX, INDEX, CUBE, VECTOR), **LEAN)
def _trajectories(phi, gamma, v, substeps, x0, select, y, w):
    nx, nv = gamma.shape[1], gamma.shape[2]
    for first in range(0, phi.shape[0], LANES):
        here = _load(w, phi, gamma, x0, first, nx, nv)
        for k in range(y.shape[1]):
            for i in range(select.size):
                at = (here + nv + select[i]) * LANES
                for lane in range(min(LANES, phi.shape[0] - first)):
                    y[first + lane, k, i] = w[at + lane]
            if k < y.shape[1] - 1:
                for fine in range(substeps):
                    here = _step(w, v, k * substeps + fine, nx, nv, here)


def trajectories(phi, gamma, v, substeps, x0, select, y):
    """Fill y (count, samples, channels): the states `select` at every `substeps`-th row of v.

    phi, gamma: of `discretise`; v: (rows, nu or 2 nu), what gamma multiplies; x0: (count, nx).
    """
    _trajectories(phi, gamma, v, substeps, x0, select, y, _trajectory_scratch(gamma))


@njit(inline="always", **OPTIONS)
def _misfit_blocks(phi, gamma, v, substeps, x0, measured, weight, cost, w, nx, nv):
    total = (nx + 2) * (nx + nv)
    for first in range(0, phi.shape[0], LANES):
        here = _load(w, phi, gamma, x0, first, nx, nv)
        broadcast(w, total, 0.0)
        for k in range(measured.shape[0]):
            for i in range(nx):
                if not math.isnan(measured[k, i]):
                    add_squared_difference(w, total, here + nv + i, measured[k, i], weight[i])
            if k < measured.shape[0] - 1:
                for fine in range(substeps):
                    here = _step(w, v, k * substeps + fine, nx, nv, here)
        for lane in range(min(LANES, phi.shape[0] - first)):
            found = w[total * LANES + lane]
            cost[first + lane] = found if found < math.inf else math.inf


@kernel(void(CUBE, CUBE, MATRIX, I8, MATRIX, MATRIX, VECTOR, VECTOR, VECTOR), **LEAN)
def _misfit(phi, gamma, v, substeps, x0, measured, weight, cost, w):
    if gamma.shape[1] == 4 and gamma.shape[2] == 2:  # as in `_discretise`
        _misfit_blocks(phi, gamma, v, substeps, x0, measured, weight, cost, w, 4, 2)
    elif gamma.shape[1] == 4 and gamma.shape[2] == 4:
        _misfit_blocks(phi, gamma, v, substeps, x0, measured, weight, cost, w, 4, 4)
    else:
        _misfit_blocks(phi, gamma, v, substeps, x0, measured, weight, cost, w, gamma.shape[1], gamma.shape[2])


def misfit(phi, gamma, v, substeps, x0, measured, weight, cost):
    """Fill cost (count,): sum of weight (x - measured)^2 over samples and states, infinite where it is not finite.

    measured: (samples, nx), NaN where there is none; weight: (nx,). Otherwise as `trajectories`; keeps none.
    """
    _misfit(phi, gamma, v, substeps, x0, measured, weight, cost, _trajectory_scratch(gamma))


def _trajectory_scratch(gamma):
    _, nx, nv = gamma.shape
    return aligned_scratch((nx + 2) * (nx + nv) + 1)
