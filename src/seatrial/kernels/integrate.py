"""Fixed-step Runge-Kutta integration of any model: replayed inputs, or a command in the loop.

Classical fourth-order scheme (Hairer, Norsett & Wanner 1993, table II.1.2). Replayed inputs run linearly
between samples; a command is held over its step.
"""

import math

import numpy as np
from numba import njit, void

from seatrial.kernels.types import COMMAND, F8, FUNCTION, I8, INDEX, MATRIX, OPTIONS, VECTOR

DIVERGED = 1e9


@njit(**OPTIONS)
def effective_input(inputs, first, last, k, gain, offset, delay, dt, out):
    """out_j = gain_j * input_j(t_k - delay_j) + offset_j, linear between samples, clamped to the segment."""
    for j in range(out.size):
        if delay[j] == 0.0:
            raw = inputs[k, j]
        else:
            place = min(max(k - delay[j] / dt, first * 1.0), last - 1.0)
            left = min(int(place), last - 2)
            raw = inputs[left, j] + (place - left) * (inputs[left + 1, j] - inputs[left, j])
        out[j] = gain[j] * raw + offset[j]


@njit(**OPTIONS)
def rk4_step(f, t, x, u0, um, u1, p, h, k, y, acc):
    """Advance x in place by one step of length h; k, y, acc are scratch of the size of x."""
    n = x.size
    f(t, x, u0, p, k)
    for i in range(n):
        acc[i] = k[i]
        y[i] = x[i] + 0.5 * h * k[i]
    f(t + 0.5 * h, y, um, p, k)
    for i in range(n):
        acc[i] += 2.0 * k[i]
        y[i] = x[i] + 0.5 * h * k[i]
    f(t + 0.5 * h, y, um, p, k)
    for i in range(n):
        acc[i] += 2.0 * k[i]
        y[i] = x[i] + h * k[i]
    f(t + h, y, u1, p, k)
    for i in range(n):
        x[i] += h / 6.0 * (acc[i] + k[i])


@njit(
    void(
        FUNCTION,
        FUNCTION,
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
        INDEX,
        I8,
        MATRIX,
        INDEX,
    ),
    **OPTIONS,
)
def replay(
    f, g, inputs, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay, select, ng, y_out, failed
):
    """Integrate segments seg_from..seg_to with recorded inputs; write selected outputs at every sample.

    Segment s owns rows offsets[s]..offsets[s+1] of inputs and y_out. Outputs: index < nx is a state, nx + i is g_i.
    failed[s] becomes the sample at which the solution left all bounds (or was not finite), else stays -1.
    """
    nx, nu = x0.shape[1], inputs.shape[1]
    x, k, scratch, acc = np.empty(nx), np.empty(nx), np.empty(nx), np.empty(nx)
    u0, u1, ua, um, ub = np.empty(nu), np.empty(nu), np.empty(nu), np.empty(nu), np.empty(nu)
    extra = np.empty(max(ng, 1))
    needs_g = False
    for i in range(select.size):
        needs_g = needs_g or select[i] >= nx
    for s in range(seg_from, seg_to):
        first, last = offsets[s], offsets[s + 1]
        x[:] = x0[s]
        par = p[s]
        gain_s, offset_s, delay_s = gain[s], offset[s], delay[s]
        effective_input(inputs, first, last, first, gain_s, offset_s, delay_s, dt, u0)
        for row in range(first, last):
            t = (row - first) * dt
            if needs_g:
                g(t, x, u0, par, extra)
            for i in range(select.size):
                y_out[row, i] = x[select[i]] if select[i] < nx else extra[select[i] - nx]
            if row == last - 1:
                break
            effective_input(inputs, first, last, row + 1, gain_s, offset_s, delay_s, dt, u1)
            h = dt / substeps
            for m in range(substeps):
                for j in range(nu):
                    slope = (u1[j] - u0[j]) / substeps
                    ua[j] = u0[j] + m * slope
                    um[j] = ua[j] + 0.5 * slope
                    ub[j] = ua[j] + slope
                rk4_step(f, t + m * h, x, ua, um, ub, par, h, k, scratch, acc)
            total = 0.0
            for i in range(nx):
                total += abs(x[i])
            if not total < DIVERGED:
                failed[s] = row + 1 - first
                y_out[row + 1 : last, :] = math.nan
                break
            for j in range(nu):
                u0[j] = u1[j]


@njit(I8(FUNCTION, COMMAND, VECTOR, VECTOR, VECTOR, VECTOR, F8, MATRIX, MATRIX), **OPTIONS)
def steer(f, command, x0, u_start, p, memory, dt, x_out, u_out):
    """Integrate with a command in the loop; returns the step at which it diverged, or -1.

    x_out, u_out: states and the input held from that sample on, one row a step.
    """
    nx = x0.size
    x, k, scratch, acc = x0.copy(), np.empty(nx), np.empty(nx), np.empty(nx)
    u = u_start.copy()
    for row in range(x_out.shape[0]):
        t = row * dt
        command(t, x, memory, u)
        total = 0.0
        for i in range(nx):
            x_out[row, i] = x[i]
            total += abs(x[i])
        for j in range(u.size):
            u_out[row, j] = u[j]
        if not total < DIVERGED:
            return row
        rk4_step(f, t, x, u, u, u, p, dt, k, scratch, acc)
    return -1


@njit(void(FUNCTION, MATRIX, MATRIX, VECTOR, F8, MATRIX), **OPTIONS)
def evaluate(f, states, inputs, p, dt, out):
    """f at every row of states and inputs: rates, outputs or bindings along a record."""
    for row in range(states.shape[0]):
        f(row * dt, states[row], inputs[row], p, out[row])
