"""Trajectories with exact discrete sensitivities: the Runge-Kutta scheme differentiated stage by stage.

For y_{k+1} = Phi(y_k, q) the columns dy/dq follow the same stages as y (internal differentiation, Bock 1981;
Hairer, Norsett & Wanner 1993, section I.14), so they are the derivatives of the computed numbers themselves.
"""

import math

import numpy as np
from numba import njit, void

from seatrial.numerics.kernels.integrate import DIVERGED, delayed_sample, effective_input
from seatrial.numerics.kernels.kernel import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, TABLE, TANGENT, VECTOR, kernel
from seatrial.numerics.kernels.simd import LANES, add_multiple, aligned_scratch, gather_scaled

OFFSET, GAIN, DELAY = 0, 1, 2
# parts of the slots of a step, each with the columns of every state: sensitivities, then the rates of a stage, their
# weighted sum, the sensitivities at the next stage, and what parameters and corrections add directly
_RATES, _SUM, _AHEAD, _ADDED, _PARTS = 1, 2, 3, 4, 5


@njit(inline="always", **OPTIONS)
def input_derivatives(inputs, first, last, k, gain, delay, dt, out):
    """Set d(effective input)/d(offset, gain, delay) at sample k, three slots an input; a clamped input has no delay."""
    for j in range(gain.size):
        delayed = k - delay[j] / dt
        place = min(max(delayed, first * 1.0), last - 1.0)
        out[3 * j + OFFSET] = 1.0
        out[3 * j + GAIN] = delayed_sample(inputs, first, last, j, place, False)
        rise = delayed_sample(inputs, first, last, j, place, True)
        out[3 * j + DELAY] = -gain[j] * rise / dt if place == delayed else 0.0


@njit(inline="always", **OPTIONS)
def propagate_tangent(jac, chain, link_p, link_u, w, s, out):
    """Set out = jac_x s + jac_p + jac_u w over structural nonzeros: chain (row, state), links (row, column, ...)."""
    ncol = out.shape[1]
    for i in range(out.shape[0]):
        for c in range(ncol):
            out[i, c] = 0.0
    for m in range(chain.shape[0]):
        i, k = chain[m, 0], chain[m, 1]
        a = jac[i, k]
        for c in range(ncol):
            out[i, c] += a * s[k, c]
    for m in range(link_p.shape[0]):
        out[link_p[m, 0], link_p[m, 2]] += jac[link_p[m, 0], link_p[m, 1]]
    for m in range(link_u.shape[0]):
        out[link_u[m, 0], link_u[m, 3]] += jac[link_u[m, 0], link_u[m, 1]] * w[link_u[m, 2]]


@njit(inline="always", **OPTIONS)
def _sensitivity_rates(chain, direct, link_u, weights, jac, entries, w, blocks, source, out):
    """Set the slots from `out` on to jac_x s + jac_p + jac_u weights, s being those from `source` on."""
    nx = jac.shape[0]
    added = _ADDED * nx * blocks
    for m in range(direct.shape[1]):
        w[direct[1, m]] = entries[direct[0, m]]
    for m in range(link_u.shape[0]):
        place = (added + link_u[m, 0] * blocks) * LANES + link_u[m, 3]
        w[place] = jac[link_u[m, 0], link_u[m, 1]] * weights[link_u[m, 2]]
    starts, entry_at, slot_at = chain[0], chain[1], chain[2]
    for i in range(nx):
        row = i * blocks
        gather_scaled(w, out + row, blocks, source, entries, entry_at, slot_at, starts[i], starts[i + 1], added + row)


@njit(inline="always", **OPTIONS)
def rk4_tangent_step(f, chain, direct, link_u, t, x, w, blocks, u0, um, u1, w0, wm, w1, p, h, jac, entries, k, y, acc):
    """Advance state x and the sensitivities in the first slots of w, both in place. Return the stages' summed size.

    chain, direct: `step_tables`; w, blocks: `step_scratch`; entries: jac, laid out in one row. k, y, acc are scratch.
    """
    nx = x.size
    n = nx * blocks
    size = 0.0
    for i in range(nx):
        y[i], acc[i] = x[i], 0.0
    for stage in range(4):
        u = u0 if stage == 0 else (u1 if stage == 3 else um)
        weights = w0 if stage == 0 else (w1 if stage == 3 else wm)
        weight = 1.0 if stage == 0 or stage == 3 else 2.0  # of the classical scheme, in sixths
        f(t + 0.5 * h * ((stage + 1) // 2), y, u, p, k, jac)
        for i in range(nx):
            acc[i] += weight * k[i]
        source = 0 if stage == 0 else _AHEAD * n
        out = _SUM * n if stage == 0 else _RATES * n
        _sensitivity_rates(chain, direct, link_u, weights, jac, entries, w, blocks, source, out)
        if stage > 0:
            for c in range(n):
                add_multiple(w, _SUM * n + c, _SUM * n + c, weight, out + c)
        if stage == 3:
            break
        ahead = h if stage == 2 else 0.5 * h
        for i in range(nx):
            y[i] = x[i] + ahead * k[i]
            size += abs(y[i])
        for c in range(n):
            add_multiple(w, _AHEAD * n + c, c, ahead, out + c)
    sixth = h / 6.0  # of the weights of the classical scheme
    for i in range(nx):
        x[i] += sixth * acc[i]
        size += abs(x[i])
    for c in range(n):
        add_multiple(w, c, c, sixth, _SUM * n + c)
    return size


@kernel(
    void(
        *(TANGENT, TANGENT, MATRIX, TABLE, VECTOR, INDEX, I8, I8, F8, I8, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX),
        *(TABLE, TABLE, TABLE, TABLE, INDEX, INDEX, MATRIX, CUBE, INDEX),
        *(MATRIX, VECTOR, MATRIX, TABLE, TABLE, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX, VECTOR, MATRIX),
    ),
    **LEAN,
)
def _replay_tangent(
    f, g, inputs, place, rise, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay,
    link_u, g_chain, g_link_p, g_link_u, start_column, select, y_out, s_out, failed,
    work_x, w, s, chain, direct, work_u, work_w, jac, entries, g_jac, g_value, g_s,
):  # fmt: skip
    nx, nu, ncol = x0.shape[1], inputs.shape[1], s_out.shape[2]
    x, k, y, acc = work_x[0], work_x[1], work_x[2], work_x[3]
    blocks = s.shape[1] // LANES
    u0, u1, um, ub = work_u[0], work_u[1], work_u[2], work_u[3]
    w0, w1, wm, wb = work_w[0], work_w[1], work_w[2], work_w[3]
    h = dt / substeps
    needs_g = False
    for i in range(select.size):
        needs_g = needs_g or select[i] >= nx
    needs_w = link_u.shape[0] + g_link_u.shape[0] > 0
    for seg in range(seg_from, seg_to):
        first, last = offsets[seg], offsets[seg + 1]
        par = p[seg]
        gain_s, offset_s, delay_s = gain[seg], offset[seg], delay[seg]
        for i in range(nx):
            x[i] = x0[seg, i]
            for j in range(s.shape[1]):
                s[i, j] = 1.0 if j == start_column[i] else 0.0
        begin, low, high = place[seg, 0], place[seg, 1], place[seg, 2]
        effective_input(inputs, low, high, begin, gain_s, offset_s, delay_s, dt, u0)
        if needs_w:
            input_derivatives(inputs, low, high, begin, gain_s, delay_s, dt, w0)
        for row in range(first, last):
            t = (row - first) * dt
            if needs_g:
                g(t, x, u0, par, g_value, g_jac)
                propagate_tangent(g_jac, g_chain, g_link_p, g_link_u, w0, s, g_s)
            for i in range(select.size):
                here = select[i]
                if here < nx:
                    y_out[row, i] = x[here]
                    for j in range(ncol):
                        s_out[row, i, j] = s[here, j]
                else:
                    y_out[row, i] = g_value[here - nx]
                    for j in range(ncol):
                        s_out[row, i, j] = g_s[here - nx, j]
            if row == last - 1:
                break
            effective_input(inputs, low, high, begin + row + 1 - first, gain_s, offset_s, delay_s, dt, u1)
            if needs_w:
                input_derivatives(inputs, low, high, begin + row + 1 - first, gain_s, delay_s, dt, w1)
            size = 0.0
            for m in range(substeps):
                for j in range(nu):
                    half = 0.5 * rise[j] * (u1[j] - u0[j]) / (substeps - m)
                    um[j] = u0[j] + half
                    ub[j] = um[j] + half
                if needs_w:
                    for j in range(3 * nu):
                        half = 0.5 * rise[j // 3] * (w1[j] - w0[j]) / (substeps - m)  # three slots an input
                        wm[j] = w0[j] + half
                        wb[j] = wm[j] + half
                size += rk4_tangent_step(f, chain, direct, link_u, t + m * h, x, w, blocks, u0, um, ub,
                                         w0, wm, wb, par, h, jac, entries, k, y, acc)  # fmt: skip
                for j in range(nu):
                    u0[j] = ub[j] if rise[j] != 0.0 or m < substeps - 1 else u1[j]
                if needs_w:
                    for j in range(3 * nu):
                        w0[j] = wb[j] if rise[j // 3] != 0.0 or m < substeps - 1 else w1[j]
            if not size < DIVERGED:
                failed[seg] = row + 1 - first
                for late in range(row + 1, last):
                    for i in range(select.size):
                        y_out[late, i] = math.nan
                        for j in range(ncol):
                            s_out[late, i, j] = math.nan
                break


def replay_tangent(
    f, g, inputs, place, rise, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay,
    chain, link_p, link_u, g_chain, g_link_p, g_link_u, start_column, select, ng, y_out, s_out, failed,
):  # fmt: skip
    """Integrate as `replay` with sensitivities: s_out[row, i, c] = d output_i / d column_c.

    start_column[i] is the column of the initial value of state i, or -1; links map Jacobian columns to columns.
    """
    nx, nu, ncol = x0.shape[1], inputs.shape[1], s_out.shape[2]
    width, rows = nx + nu + p.shape[1], max(ng, 1)
    w, s = step_scratch(nx, ncol)
    jac = np.zeros((nx, width))
    _replay_tangent(f, g, inputs, place, rise, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay,
                    link_u, g_chain, g_link_p, g_link_u, start_column, select, y_out, s_out, failed,
                    np.empty((4, nx)), w, s, *step_tables(chain, link_p, s, width), np.empty((4, nu)),
                    np.zeros((4, 3 * nu)), jac, jac.reshape(-1), np.zeros((rows, width)), np.empty(rows),
                    np.empty((rows, ncol)))  # fmt: skip


def step_scratch(nx, ncol):
    """Return zeroed slots of `rk4_tangent_step`, and the sensitivities in them, (nx, ncol or more: whole slots)."""
    blocks = -(-ncol // LANES)
    slots = aligned_scratch(_PARTS * nx * blocks)
    slots[:] = 0.0
    return slots, slots[: nx * blocks * LANES].reshape(nx, blocks * LANES)


def step_tables(chain, link_p, s, width):
    """Return what `rk4_tangent_step` looks up, from tables as `propagate_tangent` has them, rows ascending.

    First where the entries of each rate start (and the last ones end), their places in the Jacobian of that width, and
    the first slots of the states that they belong to; then of each parameter's entry its place there and in the slots.
    """
    nx, columns = s.shape
    gathered = np.zeros((3, max(len(chain), nx + 1)), dtype=np.int64)
    gathered[0, : nx + 1] = np.searchsorted(chain[:, 0], np.arange(nx + 1))
    gathered[1, : len(chain)] = chain[:, 0] * width + chain[:, 1]
    gathered[2, : len(chain)] = chain[:, 1] * (columns // LANES)
    direct = np.empty((2, len(link_p)), dtype=np.int64)
    direct[0] = link_p[:, 0] * width + link_p[:, 1]
    direct[1] = (_ADDED * nx + link_p[:, 0]) * columns + link_p[:, 2]
    return gathered, direct


@kernel(void(MATRIX, F8, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX), **OPTIONS)
def correct(inputs, dt, gain, offset, delay, out, weights):
    """Set the effective inputs of a whole run, (rows, nu), and their derivatives, (rows, 3 nu)."""
    rows = inputs.shape[0]
    for k in range(rows):
        effective_input(inputs, 0, rows, k, gain, offset, delay, dt, out[k])
        input_derivatives(inputs, 0, rows, k, gain, delay, dt, weights[k])


@kernel(void(TANGENT, MATRIX, MATRIX, MATRIX, F8, MATRIX, CUBE), **OPTIONS)
def evaluate_tangent(f, states, inputs, p, dt, out, jac):
    """Evaluate f and its Jacobian at every row of states and inputs; p has a row for each as well."""
    for row in range(states.shape[0]):
        f(row * dt, states[row], inputs[row], p[row], out[row], jac[row])
