"""One run of an affine model from parameters to residuals and their slopes in one call.

The march of `linear` for one segment, its matrices made on the spot. Slopes go side by side through vector registers,
eight columns a pass: s <- dGamma v + dE x + E s, with the derivatives of `propagate` taken along in the same lanes.
v holds the inputs that act at all: [u_k | u_{k+1} of those that run straight].
"""

import math

import numpy as np
from numba import njit

from seatrial.numerics.kernels.integrate import DIVERGED
from seatrial.numerics.kernels.kernel import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, TANGENT, VECTOR, kernel
from seatrial.numerics.kernels.linear import MAX_HALVINGS, SERIES_NORM, SERIES_TERMS, _affine_matrices
from seatrial.numerics.kernels.simd import LANES, add_scaled, aligned_scratch, broadcast

_BLOCKS = 7  # matrices of A's size that `_propagate` keeps: A, E, P, R, power, new, newer


@njit(inline="always", **OPTIONS)
def _product(z, out, a, b, rows, inner, columns):
    """Set out = a b, matrices row by row in z."""
    for i in range(rows):
        for j in range(columns):
            total = 0.0
            for k in range(inner):
                total += z[a + i * inner + k] * z[b + k * columns + j]
            z[out + i * columns + j] = total


@njit(inline="always", **OPTIONS)
def _slope_of_product(w, z, out, a, da, b, db, rows, inner, columns):
    """Set out = da b + a db in lanes; da, db, out in w, a, b in z."""
    for i in range(rows):
        for j in range(columns):
            slot = out + i * columns + j
            broadcast(w, slot, 0.0)
            add_scaled(w, slot, da + i * inner, 1, z, b + j, columns, inner)
            add_scaled(w, slot, db + j, columns, z, a + i * inner, 1, inner)


@njit(inline="always", **OPTIONS)
def _scale_by_halving(z, a, n, h):
    """Scale A to A h / 2^k, small; return k, or the most if it stays large or is not finite."""
    size = 0.0
    for i in range(n):
        row = 0.0
        for j in range(n):
            row += abs(z[a + i * n + j])
        size = max(size, row)
    size *= h
    count, step = 0, h
    while not size <= SERIES_NORM and count < MAX_HALVINGS:
        size *= 0.5
        step *= 0.5
        count += 1
    for m in range(n * n):
        z[a + m] *= step
    return count


@njit(inline="always", **OPTIONS)
def _scaled_sum(z, out, factor, a, b, c, size):
    for m in range(size):
        z[out + m] = factor * (z[a + m] + z[b + m] + (z[c + m] if c >= 0 else 0.0))


@njit(inline="always", **OPTIONS)
def _propagate(z, w, n, h):
    """Set E, P/h, R/h of `propagators` at z[n^2 ...], from A at z[0], and slopes at the same slots from dA at w[0].

    Both are laid out [A | E | P | R | power | new | newer], n^2 each. Return whether A could be scaled.
    """
    nn, wide = n * n, n * n * LANES
    e, p, r, power, new = nn, 2 * nn, 3 * nn, 4 * nn, 4 * nn + nn
    newer = new + nn
    halvings = _scale_by_halving(z, 0, n, h)
    if halvings == MAX_HALVINGS:
        return False
    for m in range(nn):
        one = 1.0 if m % (n + 1) == 0 else 0.0
        z[e + m], z[p + m], z[r + m], z[power + m] = one, one, 0.5 * one, one
    step = h * 0.5**halvings
    for m in range(wide):
        w[m] *= step
        w[e * LANES + m] = w[p * LANES + m] = w[r * LANES + m] = w[power * LANES + m] = 0.0
    for k in range(1, SERIES_TERMS + 1):
        over, first, second = 1.0 / k, 1.0 / (k + 1), 1.0 / ((k + 1) * (k + 2))
        _slope_of_product(w, z, new, power, power, 0, 0, n, n, n)
        for m in range(wide):
            d = over * w[new * LANES + m]
            w[power * LANES + m] = d
            w[e * LANES + m] += d
            w[p * LANES + m] += first * d
            w[r * LANES + m] += second * d
        _product(z, new, power, 0, n, n, n)
        for m in range(nn):
            d = over * z[new + m]
            z[power + m] = d
            z[e + m] += d
            z[p + m] += first * d
            z[r + m] += second * d
    for _ in range(halvings):
        _slope_of_product(w, z, new, e, e, r, r, n, n, n)
        _slope_of_product(w, z, newer, e, e, p, p, n, n, n)
        _slope_of_product(w, z, power, e, e, e, e, n, n, n)
        _scaled_sum(w, r * LANES, 0.25, new * LANES, p * LANES, r * LANES, wide)
        _scaled_sum(w, p * LANES, 0.5, newer * LANES, p * LANES, -1, wide)
        for m in range(wide):
            w[e * LANES + m] = w[power * LANES + m]
        _product(z, new, e, r, n, n, n)
        _product(z, newer, e, p, n, n, n)
        _product(z, power, e, e, n, n, n)
        _scaled_sum(z, r, 0.25, new, p, r, nn)
        _scaled_sum(z, p, 0.5, newer, p, -1, nn)
        for m in range(nn):
            z[e + m] = z[power + m]
    return True


@njit(inline="always", **OPTIONS)
def _discrete_input_matrix(z, n, h, active_inputs, ramp_inputs, b_start, gamma_start):
    """Set Gamma from P, R and B (n, nb): [h P B - h R B | h R B], the ramp R only in columns that run straight."""
    nb, nn = active_inputs.size, n * n
    nv = nb + ramp_inputs.size
    for i in range(n):
        for j in range(nb):
            total = 0.0
            for m in range(n):
                total += z[2 * nn + i * n + m] * z[b_start + m * nb + j]
            z[gamma_start + i * nv + j] = h * total
        for k in range(ramp_inputs.size):
            j, total = ramp_inputs[k], 0.0
            for m in range(n):
                total += z[3 * nn + i * n + m] * z[b_start + m * nb + j]
            z[gamma_start + i * nv + nb + k] = h * total
            z[gamma_start + i * nv + j] -= h * total


@njit(inline="always", **OPTIONS)
def _slope_of_input_matrix(w, z, n, h, active_inputs, ramp_inputs, b_start, gamma_start):
    """Set the slope of `_discrete_input_matrix`, B and its slope at the same places of z and w."""
    nb, nn = active_inputs.size, n * n
    nv = nb + ramp_inputs.size
    for i in range(n):
        for j in range(nb):
            out = gamma_start + i * nv + j
            broadcast(w, out, 0.0)
            add_scaled(w, out, 2 * nn + i * n, 1, z, b_start + j, nb, n)
            add_scaled(w, out, b_start + j, nb, z, 2 * nn + i * n, 1, n)
            for lane in range(LANES):
                w[out * LANES + lane] *= h
        for k in range(ramp_inputs.size):
            j, out = ramp_inputs[k], gamma_start + i * nv + nb + k
            broadcast(w, out, 0.0)
            add_scaled(w, out, 3 * nn + i * n, 1, z, b_start + j, nb, n)
            add_scaled(w, out, b_start + j, nb, z, 3 * nn + i * n, 1, n)
            for lane in range(LANES):
                w[out * LANES + lane] *= h
                w[(gamma_start + i * nv + j) * LANES + lane] -= w[out * LANES + lane]


@njit(inline="always", **OPTIONS)
def _load_plant(z, n, plant, active_inputs):
    """Copy A and B of the plant into z; return where B begins."""
    at_b = _BLOCKS * n * n
    for i in range(n):
        for j in range(n):
            z[i * n + j] = plant[i, j]
        for j in range(active_inputs.size):
            z[at_b + i * active_inputs.size + j] = plant[i, n + active_inputs[j]]
    return at_b


@njit(inline="always", **OPTIONS)
def _advance(z, n, nv, gamma_start, state_start):
    """Move the state behind [v | x] at `state_start` one step; return its size."""
    size, new = 0.0, state_start + nv + n
    for i in range(n):
        total = 0.0
        for j in range(nv):
            total += z[gamma_start + i * nv + j] * z[state_start + j]
        for j in range(n):
            total += z[n * n + i * n + j] * z[state_start + nv + j]
        z[new + i] = total
    for i in range(n):
        z[state_start + nv + i] = z[new + i]
        size += abs(z[new + i])
    return size


@njit(inline="always", **OPTIONS)
def _load_plant_slopes(w, n, dplant, first_parameter, active_inputs, b_start):
    """Copy slopes of A and B by the parameters from `first_parameter` on; zero in lanes beyond the last."""
    for lane in range(LANES):
        q = first_parameter + lane
        is_parameter = q < dplant.shape[0]
        for i in range(n):
            for j in range(n):
                w[(i * n + j) * LANES + lane] = dplant[q, i, j] if is_parameter else 0.0
            for j in range(active_inputs.size):
                w[(b_start + i * active_inputs.size + j) * LANES + lane] = (
                    dplant[q, i, n + active_inputs[j]] if is_parameter else 0.0
                )


@njit(inline="always", **OPTIONS)
def _simulate_with_slopes(
    n, plant, dplant, active_inputs, ramp_inputs, h, v, substeps, x0, start_column, select, measured, weight,
    residual, jacobian, z, w
):  # fmt: skip
    nb, nv, nn, ny = active_inputs.size, v.shape[1], n * n, select.size
    samples = measured.shape[0]
    for first in range(0, jacobian.shape[1], LANES):
        at_b = _load_plant(z, n, plant, active_inputs)
        at_gamma = at_b + n * nb
        at = at_gamma + n * nv
        _load_plant_slopes(w, n, dplant, first, active_inputs, at_b)
        if not _propagate(z, w, n, h):
            return False
        _discrete_input_matrix(z, n, h, active_inputs, ramp_inputs, at_b, at_gamma)
        _slope_of_input_matrix(w, z, n, h, active_inputs, ramp_inputs, at_b, at_gamma)
        here, there = at, at + n
        for i in range(n):
            z[at + nv + i] = x0[i]
            for lane in range(LANES):
                w[(here + i) * LANES + lane] = 1.0 if start_column[i] == first + lane else 0.0
        for k in range(samples):
            for i in range(ny):
                row, state = k * ny + i, select[i]
                factor, off = 0.0, 0.0
                if not math.isnan(measured[k, i]):
                    factor, off = weight[i], weight[i] * (z[at + nv + state] - measured[k, i])
                residual[row] = off
                for lane in range(LANES):
                    jacobian[row, first + lane] = factor * w[(here + state) * LANES + lane]
            if k == samples - 1:
                break
            size = 0.0
            for step in range(k * substeps, k * substeps + substeps):
                for j in range(nv):
                    z[at + j] = v[step, j]
                for i in range(n):
                    broadcast(w, there + i, 0.0)
                    add_scaled(w, there + i, at_gamma + i * nv, 1, z, at, 1, nv)
                    add_scaled(w, there + i, nn + i * n, 1, z, at + nv, 1, n)
                    add_scaled(w, there + i, here, 1, z, nn + i * n, 1, n)
                here, there = there, here
                size = _advance(z, n, nv, at_gamma, at)
            if not size < DIVERGED:
                return False
    return True


@kernel(
    I8(
        *(TANGENT, I8, INDEX, INDEX, INDEX, VECTOR, F8, MATRIX, I8, VECTOR, INDEX, INDEX, MATRIX, VECTOR, VECTOR),
        *(MATRIX, MATRIX, CUBE, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX, VECTOR, VECTOR),
    ),
    **LEAN,
)
def _residuals_and_jacobian(
    f, nu, parameter_index, active_inputs, ramp_inputs, p, h, v, substeps, x0, start_column, select, measured,
    weight, residual, jacobian, plant, dplant, x, u, out, jac, slope_at_origin, z, w
):  # fmt: skip
    n = x0.size
    _affine_matrices(f, n, nu, parameter_index, p, plant, dplant, x, u, out, jac, slope_at_origin)
    if n == 4:
        return _simulate_with_slopes(
            4, plant, dplant, active_inputs, ramp_inputs, h, v, substeps, x0, start_column, select, measured, weight,
            residual, jacobian, z, w,
        )  # fmt: skip
    return _simulate_with_slopes(
        n, plant, dplant, active_inputs, ramp_inputs, h, v, substeps, x0, start_column, select, measured, weight,
        residual, jacobian, z, w,
    )  # fmt: skip


def _allocate_scratch(nx, nu, count, nb, nv, p):
    """Return the scratch of `_affine_matrices`, and the length of z for nb active inputs and nv rows of them."""
    size = _BLOCKS * nx * nx + nx * (nb + nv) + 2 * nx + nv + nx
    plant, jacobian = np.empty((nx, nx + nu + 1)), np.zeros((nx, nx + nu + len(p)))
    slopes = np.empty((count, nx, nx + nu + 1)), np.empty(nx), np.empty(nu), np.empty(nx)
    return (plant, *slopes, jacobian, np.empty((nx, max(count, 1)))), size


def residuals_and_jacobian(
    f, nu, parameter_index, active_inputs, ramp_inputs, p, h, v, substeps, x0, start_column, columns, select,
    measured, weight
):  # fmt: skip
    """Return residuals weight (x - measured), (samples ny,), and Jacobian (samples ny, columns); 0 where unmeasured.

    f: rates with Jacobian, nu inputs; active_inputs: columns of [u | 1] that act; ramp_inputs: places among these of
    inputs that are not held; h: fine step, s; v: ((samples - 1) substeps, nv). select: states that are compared, (ny,);
    measured: (samples, ny), NaN where nothing was measured; weight: (ny,), 1 over the noise. Columns: the parameters
    of `parameter_index`, then initial states; start_column: (nx,), column of each, or -1. None in place of both if the
    run leaves all bounds.
    """
    residual, jacobian = np.empty(measured.size), np.empty((measured.size, -(-columns // LANES) * LANES))
    nb = len(active_inputs)
    scratch, size = _allocate_scratch(len(x0), nu, len(parameter_index), nb, nb + len(ramp_inputs), p)
    is_fine = _residuals_and_jacobian(
        f, nu, parameter_index, active_inputs, ramp_inputs, p, h, v, substeps, x0, start_column, select, measured,
        weight, residual, jacobian, *scratch, np.empty(size), aligned_scratch(size),
    )  # fmt: skip
    return (residual, jacobian[:, :columns]) if is_fine else None
