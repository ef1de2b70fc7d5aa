"""Trajectories with exact discrete sensitivities: the Runge-Kutta scheme differentiated stage by stage.

For y_{k+1} = Phi(y_k, q) the columns dy/dq follow the same stages as y (internal differentiation, Bock 1981;
Hairer, Norsett & Wanner 1993, section I.14), so they are the derivatives of the computed numbers themselves.
"""

import math

import numpy as np
from numba import njit, void

from seatrial.numerics.kernels.integrate import DIVERGED, effective_input
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, TABLE, TANGENT, VECTOR

OFFSET, GAIN, DELAY = 0, 1, 2


@njit(inline="always", **OPTIONS)
def input_derivatives(inputs, first, last, k, gain, delay, dt, out):
    """Set d(effective input)/d(offset, gain, delay) at sample k, three slots an input; a clamped input has no delay."""
    for j in range(gain.size):
        delayed = k - delay[j] / dt
        place = min(max(delayed, first * 1.0), last - 1.0)
        left = min(int(place), last - 2)
        rise = inputs[left + 1, j] - inputs[left, j]
        out[3 * j + OFFSET] = 1.0
        out[3 * j + GAIN] = inputs[left, j] + (place - left) * rise
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
def rk4_tangent_step(f, chain, link_p, link_u, t, x, s, u0, um, u1, w0, wm, w1, p, h, jac, k, y, acc, sk, sy, sacc):
    """Advance state x and sensitivities s, both in place; the rest is scratch. Return the stages' summed size."""
    nx, ncol = s.shape
    size = 0.0
    f(t, x, u0, p, k, jac)
    propagate_tangent(jac, chain, link_p, link_u, w0, s, sk)
    for i in range(nx):
        acc[i] = k[i]
        y[i] = x[i] + 0.5 * h * k[i]
        size += abs(y[i])
        for j in range(ncol):
            sacc[i, j] = sk[i, j]
            sy[i, j] = s[i, j] + 0.5 * h * sk[i, j]
    for stage in range(2):
        c = 0.5 * h if stage == 0 else h
        f(t + 0.5 * h, y, um, p, k, jac)
        propagate_tangent(jac, chain, link_p, link_u, wm, sy, sk)
        for i in range(nx):
            acc[i] += 2.0 * k[i]
            y[i] = x[i] + c * k[i]
            size += abs(y[i])
            for j in range(ncol):
                sacc[i, j] += 2.0 * sk[i, j]
                sy[i, j] = s[i, j] + c * sk[i, j]
    f(t + h, y, u1, p, k, jac)
    propagate_tangent(jac, chain, link_p, link_u, w1, sy, sk)
    for i in range(nx):
        x[i] += h / 6.0 * (acc[i] + k[i])  # weights of the classical scheme
        size += abs(x[i])
        for j in range(ncol):
            s[i, j] += h / 6.0 * (sacc[i, j] + sk[i, j])  # as those of the state
    return size


@kernel(
    void(
        *(TANGENT, TANGENT, MATRIX, INDEX, I8, I8, F8, I8, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX),
        *(TABLE, TABLE, TABLE, TABLE, TABLE, TABLE, INDEX, INDEX, MATRIX, CUBE, INDEX),
        *(MATRIX, CUBE, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX),
    ),
    **LEAN,
)
def _replay_tangent(
    f, g, inputs, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay,
    chain, link_p, link_u, g_chain, g_link_p, g_link_u, start_column, select, y_out, s_out, failed,
    work_x, work_s, work_u, work_w, jac, g_jac, g_value, g_s,
):  # fmt: skip
    nx, nu, ncol = x0.shape[1], inputs.shape[1], s_out.shape[2]
    x, k, y, acc = work_x[0], work_x[1], work_x[2], work_x[3]
    s, sk, sy, sacc = work_s[0], work_s[1], work_s[2], work_s[3]
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
            for j in range(ncol):
                s[i, j] = 1.0 if j == start_column[i] else 0.0
        effective_input(inputs, first, last, first, gain_s, offset_s, delay_s, dt, u0)
        if needs_w:
            input_derivatives(inputs, first, last, first, gain_s, delay_s, dt, w0)
        for row in range(first, last):
            t = (row - first) * dt
            if needs_g:
                g(t, x, u0, par, g_value, g_jac)
                propagate_tangent(g_jac, g_chain, g_link_p, g_link_u, w0, s, g_s)
            for i in range(select.size):
                is_state = select[i] < nx
                y_out[row, i] = x[select[i]] if is_state else g_value[select[i] - nx]
                for j in range(ncol):
                    s_out[row, i, j] = s[select[i], j] if is_state else g_s[select[i] - nx, j]
            if row == last - 1:
                break
            effective_input(inputs, first, last, row + 1, gain_s, offset_s, delay_s, dt, u1)
            if needs_w:
                input_derivatives(inputs, first, last, row + 1, gain_s, delay_s, dt, w1)
            size = 0.0
            for m in range(substeps):
                for j in range(nu):
                    half = 0.5 * (u1[j] - u0[j]) / (substeps - m)
                    um[j] = u0[j] + half
                    ub[j] = um[j] + half
                if needs_w:
                    for j in range(3 * nu):
                        half = 0.5 * (w1[j] - w0[j]) / (substeps - m)
                        wm[j] = w0[j] + half
                        wb[j] = wm[j] + half
                size += rk4_tangent_step(f, chain, link_p, link_u, t + m * h, x, s, u0, um, ub, w0, wm, wb, par, h,
                                         jac, k, y, acc, sk, sy, sacc)  # fmt: skip
                for j in range(nu):
                    u0[j] = ub[j]
                if needs_w:
                    for j in range(3 * nu):
                        w0[j] = wb[j]
            if not size < DIVERGED:
                failed[seg] = row + 1 - first
                for late in range(row + 1, last):
                    for i in range(select.size):
                        y_out[late, i] = math.nan
                        for j in range(ncol):
                            s_out[late, i, j] = math.nan
                break


def replay_tangent(
    f, g, inputs, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay,
    chain, link_p, link_u, g_chain, g_link_p, g_link_u, start_column, select, ng, y_out, s_out, failed,
):  # fmt: skip
    """Integrate as `replay` with sensitivities: s_out[row, i, c] = d output_i / d column_c.

    start_column[i] is the column of the initial value of state i, or -1; links map Jacobian columns to columns.
    """
    nx, nu, ncol = x0.shape[1], inputs.shape[1], s_out.shape[2]
    width, rows = nx + nu + p.shape[1], max(ng, 1)
    _replay_tangent(f, g, inputs, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay,
                    chain, link_p, link_u, g_chain, g_link_p, g_link_u, start_column, select, y_out, s_out, failed,
                    np.empty((4, nx)), np.empty((4, nx, ncol)), np.empty((4, nu)), np.zeros((4, 3 * nu)),
                    np.zeros((nx, width)), np.zeros((rows, width)), np.empty(rows), np.empty((rows, ncol)))  # fmt: skip


@kernel(void(TANGENT, MATRIX, MATRIX, MATRIX, F8, MATRIX, CUBE), **OPTIONS)
def evaluate_tangent(f, states, inputs, p, dt, out, jac):
    """Evaluate f and its Jacobian at every row of states and inputs; p has a row for each as well."""
    for row in range(states.shape[0]):
        f(row * dt, states[row], inputs[row], p[row], out[row], jac[row])
