"""One run of an affine model from parameters to residuals in one call, with or without their slopes.

The march of `linear` for one segment, its matrices made on the spot by `affine` and `propagators`. Sensitivities go
side by side through vector registers, eight columns a pass: s_i <- dGamma_i v + dE_i x + E_i s.
v holds the inputs that act at all: [u_k | u_{k+1} of those that run straight].
"""

import math

import numpy as np
from numba import njit, void

from seatrial.kernels.integrate import DIVERGED
from seatrial.kernels.lanes import LANES, dot, scratch, spread
from seatrial.kernels.linear import _affine
from seatrial.kernels.propagate import _propagators
from seatrial.kernels.types import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, QUARTIC, TANGENT, VECTOR


@njit(inline="always", **OPTIONS)
def _add_driven(hold, ramp, b, used, straight, gamma):
    """gamma += [hold b - ramp b | ramp b], the ramp only in columns that run straight."""
    nx = hold.shape[0]
    for i in range(nx):
        for k in range(used.size):
            for m in range(nx):
                gamma[i, k] += hold[i, m] * b[m, nx + used[k]]
        for k in range(straight.size):
            late = 0.0
            for m in range(nx):
                late += ramp[i, m] * b[m, nx + used[straight[k]]]
            gamma[i, used.size + k] += late
            gamma[i, straight[k]] -= late


@njit(
    void(
        *(TANGENT, I8, INDEX, INDEX, INDEX, VECTOR, F8, CUBE, QUARTIC, MATRIX, CUBE),
        *(MATRIX, CUBE, MATRIX, CUBE, CUBE, CUBE, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX),
    ),
    **LEAN,
)
def _discrete(
    f, nu, wanted, used, straight, p, h, value, slope, gamma, dgamma,
    plant, dplant, a, da, power, dpower, x, u, out, jac, rest,
):  # fmt: skip
    nx = a.shape[0]
    _affine(f, nx, nu, wanted, p, plant, dplant, x, u, out, jac, rest)
    for i in range(nx):
        for k in range(nx):
            a[i, k] = plant[i, k]
            for q in range(wanted.size):
                da[q, i, k] = dplant[q, i, k]
    _propagators(a, da, h, value, slope, power, dpower)
    _add_driven(value[1], value[2], plant, used, straight, gamma)
    for q in range(wanted.size):
        _add_driven(slope[q, 1], slope[q, 2], plant, used, straight, dgamma[q])
        _add_driven(value[1], value[2], dplant[q], used, straight, dgamma[q])


def discrete(f, nx, nu, wanted, used, straight, p, h):
    """E (nx, nx) and Gamma (nx, nv) over a step h [s], then their derivatives by the parameters of index `wanted`.

    f: rates with Jacobian; used: columns of [u | 1] that act; straight: places in `used` of inputs that are not held.
    Derivatives (wanted, nx, nx) and (wanted, nx, nv). NaN where the plant is too fast to be scaled.
    """
    count, nv, width = len(wanted), len(used) + len(straight), nx + nu + 1
    value, slope = np.empty((3, nx, nx)), np.empty((count, 3, nx, nx))
    gamma, dgamma = np.zeros((nx, nv)), np.zeros((count, nx, nv))
    _discrete(f, nu, wanted, used, straight, p, h, value, slope, gamma, dgamma,
              np.empty((nx, width)), np.empty((count, nx, width)), np.empty((nx, nx)), np.empty((count, nx, nx)),
              np.empty((2, nx, nx)), np.empty((count, nx, nx)), np.empty(nx), np.empty(max(nu, 1)), np.empty(nx),
              np.zeros((nx, nx + nu + len(p))), np.empty((nx, max(count, 1))))  # fmt: skip
    return value[0], gamma, slope[:, 0], dgamma


@njit(inline="always", **OPTIONS)
def _advance(e, gamma, v, x, y):
    """x <- e x + gamma v; y is scratch. Returns the size of the new state."""
    size = 0.0
    for i in range(x.size):
        total = 0.0
        for j in range(v.size):
            total += gamma[i, j] * v[j]
        for k in range(x.size):
            total += e[i, k] * x[k]
        y[i] = total
    for i in range(x.size):
        x[i] = y[i]
        size += abs(y[i])
    return size


@njit(F8(MATRIX, MATRIX, MATRIX, I8, VECTOR, INDEX, MATRIX, VECTOR, VECTOR), **LEAN)
def _misfit(e, gamma, v, fine, x, select, measured, weight, y):
    total = 0.0
    samples = measured.shape[0]
    for k in range(samples):
        for i in range(select.size):
            if not math.isnan(measured[k, i]):
                off = (x[select[i]] - measured[k, i]) * weight[i]
                total += off * off
        if k < samples - 1:
            size = 0.0
            for step in range(k * fine, k * fine + fine):
                size = _advance(e, gamma, v[step], x, y)
            if not size < DIVERGED:
                return math.inf
    return 0.5 * total


def misfit(e, gamma, v, fine, x0, select, measured, weight):
    """Half the sum of squares of weight (x - measured); infinite if the run leaves all bounds.

    v: ((samples - 1) fine, nv); select: states that are compared, (ny,); measured: (samples, ny), NaN where nothing
    was measured; weight: (ny,), 1 over the noise.
    """
    return _misfit(e, gamma, v, fine, x0.copy(), select, measured, weight, np.empty_like(x0))


@njit(inline="always", **OPTIONS)
def _load(w, e, gamma, de, dgamma, starts, first, here):
    """Slots: rows [dGamma | dE | E] of the columns from `first` on, then [v | x | s] at `here`."""
    nx, nv = gamma.shape
    width = nv + 2 * nx
    for i in range(nx):
        for lane in range(LANES):
            q = first + lane
            for j in range(nv):
                w[(i * width + j) * LANES + lane] = dgamma[q, i, j] if q < de.shape[0] else 0.0
            for j in range(nx):
                w[(i * width + nv + j) * LANES + lane] = de[q, i, j] if q < de.shape[0] else 0.0
            w[(here + nv + nx + i) * LANES + lane] = 1.0 if starts[i] == q else 0.0
        for j in range(nx):
            spread(w, i * width + nv + nx + j, e[i, j])


@njit(
    I8(MATRIX, MATRIX, CUBE, CUBE, MATRIX, I8, MATRIX, INDEX, INDEX, MATRIX, VECTOR, VECTOR, MATRIX, VECTOR, VECTOR,
       VECTOR),
    **LEAN,
)  # fmt: skip
def _slopes(e, gamma, de, dgamma, v, fine, x0, starts, select, measured, weight, residual, jacobian, x, y, w):
    nx, nv = gamma.shape
    width, samples, ny = nv + 2 * nx, measured.shape[0], select.size
    here, next_s = nx * width, nx * width + width
    for first in range(0, jacobian.shape[1], LANES):
        _load(w, e, gamma, de, dgamma, starts, first, here)
        for i in range(nx):
            x[i] = x0[0, i]
        for k in range(samples):
            for i in range(ny):
                row, state = k * ny + i, select[i]
                factor, off = 0.0, 0.0
                if not math.isnan(measured[k, i]):
                    factor, off = weight[i], weight[i] * (x[state] - measured[k, i])
                residual[row] = off
                for lane in range(LANES):
                    jacobian[row, first + lane] = factor * w[(here + nv + nx + state) * LANES + lane]
            if k == samples - 1:
                break
            size = 0.0
            for step in range(k * fine, k * fine + fine):
                for j in range(nv):
                    spread(w, here + j, v[step, j])
                for j in range(nx):
                    spread(w, here + nv + j, x[j])
                for i in range(nx):
                    dot(w, next_s + i, i * width, here, 1, width)
                for i in range(nx * LANES):
                    w[(here + nv + nx) * LANES + i] = w[next_s * LANES + i]
                size = _advance(e, gamma, v[step], x, y)
            if not size < DIVERGED:
                return k + 1
    return -1


def slopes(e, gamma, de, dgamma, v, fine, x0, starts, columns, select, measured, weight):
    """Residuals (samples ny,) of `misfit` and their Jacobian (samples ny, columns), zero where nothing was measured.

    Columns: parameters as in `de`, then initial states; starts: (nx,), column of each initial state or -1.
    None in place of both if the run leaves all bounds.
    """
    nx, nv = gamma.shape
    rows, padded = measured.size, -(-columns // LANES) * LANES
    residual, jacobian = np.empty(rows), np.empty((rows, padded))
    room = scratch((nx + 1) * (nv + 2 * nx) + nx)
    failed = _slopes(e, gamma, np.ascontiguousarray(de), dgamma, v, fine, x0[None], starts, select, measured, weight,
                     residual, jacobian, np.empty(nx), np.empty(nx), room)  # fmt: skip
    return None if failed >= 0 else (residual, jacobian[:, :columns])
