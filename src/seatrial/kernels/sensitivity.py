"""Trajectories with exact discrete sensitivities: the Runge-Kutta scheme differentiated stage by stage.

For y_{k+1} = Phi(y_k, q) the columns dy/dq follow the same stages as y (internal differentiation, Bock 1981;
Hairer, Norsett & Wanner 1993, section I.14), so they are the derivatives of the computed numbers themselves.
"""

import math

import numpy as np
from numba import njit, void

from seatrial.kernels.integrate import DIVERGED, effective_input
from seatrial.kernels.types import CUBE, F8, I8, INDEX, MATRIX, OPTIONS, TABLE, TANGENT

OFFSET, GAIN, DELAY = 0, 1, 2


@njit(**OPTIONS)
def input_weights(inputs, first, last, k, gain, delay, dt, out):
    """d(effective input)/d(offset, gain, delay) at sample k, three slots an input; clamped, no delay is felt."""
    for j in range(gain.size):
        delayed = k - delay[j] / dt
        place = min(max(delayed, first * 1.0), last - 1.0)
        left = min(int(place), last - 2)
        rise = inputs[left + 1, j] - inputs[left, j]
        out[3 * j + OFFSET] = 1.0
        out[3 * j + GAIN] = inputs[left, j] + (place - left) * rise
        out[3 * j + DELAY] = -gain[j] * rise / dt if place == delayed else 0.0


@njit(**OPTIONS)
def push(jac, chain, link_p, link_u, w, s, out):
    """out = jac_x s + jac_p + jac_u w, over structural nonzeros: chain (row, state), links (row, jac column, ...)."""
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


@njit(**OPTIONS)
def rk4_tangent_step(f, chain, link_p, link_u, t, x, s, u0, um, u1, w0, wm, w1, p, h, jac, k, y, acc, sk, sy, sacc):
    """One step of state x and sensitivities s, both in place; the rest is scratch."""
    nx, ncol = s.shape
    for stage in range(4):
        u, w = (u0, w0) if stage == 0 else ((u1, w1) if stage == 3 else (um, wm))
        c = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
        if stage == 0:
            f(t, x, u, p, k, jac)
            push(jac, chain, link_p, link_u, w, s, sk)
        else:
            for i in range(nx):
                y[i] = x[i] + c * k[i]
                for j in range(ncol):
                    sy[i, j] = s[i, j] + c * sk[i, j]
            f(t + c, y, u, p, k, jac)
            push(jac, chain, link_p, link_u, w, sy, sk)
        weight = 1.0 if stage == 0 or stage == 3 else 2.0
        for i in range(nx):
            acc[i] = k[i] if stage == 0 else acc[i] + weight * k[i]
            for j in range(ncol):
                sacc[i, j] = sk[i, j] if stage == 0 else sacc[i, j] + weight * sk[i, j]
    for i in range(nx):
        x[i] += h / 6.0 * acc[i]
        for j in range(ncol):
            s[i, j] += h / 6.0 * sacc[i, j]


@njit(
    void(
        TANGENT,
        TANGENT,
        MATRIX,
        INDEX,
        I8,
        I8,
        F8,
        I8,
        MATRIX,
        MATRIX,
        MATRIX,
        MATRIX,
        MATRIX,
        TABLE,
        TABLE,
        TABLE,
        TABLE,
        TABLE,
        TABLE,
        INDEX,
        INDEX,
        I8,
        MATRIX,
        CUBE,
        INDEX,
    ),
    **OPTIONS,
)
def replay_tangent(
    f,
    g,
    inputs,
    offsets,
    seg_from,
    seg_to,
    dt,
    substeps,
    x0,
    p,
    gain,
    offset,
    delay,
    chain,
    link_p,
    link_u,
    g_chain,
    g_link_p,
    g_link_u,
    start_column,
    select,
    ng,
    y_out,
    s_out,
    failed,
):
    """`replay` with sensitivities: s_out[row, i, c] = d output_i / d column_c.

    start_column[i] is the column of the initial value of state i, or -1; links map Jacobian columns to columns.
    """
    nx, nu, ncol = x0.shape[1], inputs.shape[1], s_out.shape[2]
    width = nx + nu + p.shape[1]
    x, k, y, acc = np.empty(nx), np.empty(nx), np.empty(nx), np.empty(nx)
    s, sk, sy, sacc = np.empty((nx, ncol)), np.empty((nx, ncol)), np.empty((nx, ncol)), np.empty((nx, ncol))
    jac = np.zeros((nx, width))
    g_jac = np.zeros((max(ng, 1), width))
    g_value, g_s = np.empty(max(ng, 1)), np.empty((max(ng, 1), ncol))
    u0, u1, ua, um, ub = np.empty(nu), np.empty(nu), np.empty(nu), np.empty(nu), np.empty(nu)
    w0, w1, wa, wm, wb = np.zeros(3 * nu), np.zeros(3 * nu), np.zeros(3 * nu), np.zeros(3 * nu), np.zeros(3 * nu)
    needs_g = False
    for i in range(select.size):
        needs_g = needs_g or select[i] >= nx
    needs_w = link_u.shape[0] + g_link_u.shape[0] > 0
    for seg in range(seg_from, seg_to):
        first, last = offsets[seg], offsets[seg + 1]
        x[:] = x0[seg]
        par = p[seg]
        gain_s, offset_s, delay_s = gain[seg], offset[seg], delay[seg]
        s[:, :] = 0.0
        for i in range(nx):
            if start_column[i] >= 0:
                s[i, start_column[i]] = 1.0
        effective_input(inputs, first, last, first, gain_s, offset_s, delay_s, dt, u0)
        if needs_w:
            input_weights(inputs, first, last, first, gain_s, delay_s, dt, w0)
        for row in range(first, last):
            t = (row - first) * dt
            if needs_g:
                g(t, x, u0, par, g_value, g_jac)
                push(g_jac, g_chain, g_link_p, g_link_u, w0, s, g_s)
            for i in range(select.size):
                if select[i] < nx:
                    y_out[row, i] = x[select[i]]
                    s_out[row, i, :] = s[select[i]]
                else:
                    y_out[row, i] = g_value[select[i] - nx]
                    s_out[row, i, :] = g_s[select[i] - nx]
            if row == last - 1:
                break
            effective_input(inputs, first, last, row + 1, gain_s, offset_s, delay_s, dt, u1)
            if needs_w:
                input_weights(inputs, first, last, row + 1, gain_s, delay_s, dt, w1)
            h = dt / substeps
            for m in range(substeps):
                a, b = m / substeps, (m + 1) / substeps
                for j in range(nu):
                    ua[j] = u0[j] + a * (u1[j] - u0[j])
                    ub[j] = u0[j] + b * (u1[j] - u0[j])
                    um[j] = 0.5 * (ua[j] + ub[j])
                if needs_w:
                    for j in range(3 * nu):
                        wa[j] = w0[j] + a * (w1[j] - w0[j])
                        wb[j] = w0[j] + b * (w1[j] - w0[j])
                        wm[j] = 0.5 * (wa[j] + wb[j])
                rk4_tangent_step(
                    f,
                    chain,
                    link_p,
                    link_u,
                    t + m * h,
                    x,
                    s,
                    ua,
                    um,
                    ub,
                    wa,
                    wm,
                    wb,
                    par,
                    h,
                    jac,
                    k,
                    y,
                    acc,
                    sk,
                    sy,
                    sacc,
                )
            total = 0.0
            for i in range(nx):
                total += abs(x[i])
            if not total < DIVERGED:
                failed[seg] = row + 1 - first
                y_out[row + 1 : last, :] = math.nan
                s_out[row + 1 : last, :, :] = math.nan
                break
            for j in range(nu):
                u0[j] = u1[j]
            for j in range(3 * nu):
                w0[j] = w1[j]


@njit(void(TANGENT, MATRIX, MATRIX, MATRIX, F8, MATRIX, CUBE), **OPTIONS)
def evaluate_tangent(f, states, inputs, p, dt, out, jac):
    """f and its Jacobian at every row of states and inputs; p has a row for each as well."""
    for row in range(states.shape[0]):
        f(row * dt, states[row], inputs[row], p[row], out[row], jac[row])
