"""Fixed-step Runge-Kutta integration of any model with replayed inputs, held or straight between samples.

Classical fourth-order scheme (Hairer, Norsett & Wanner 1993, table II.1.2).
"""

import math

import numpy as np
from numba import njit, void

from seatrial.numerics.kernels.kernel import F8, FUNCTION, I8, INDEX, LEAN, MATRIX, OPTIONS, TABLE, VECTOR, kernel

DIVERGED = 1e9  # summed size of states, SI, that no ship reaches; chosen


@njit(inline="always", **OPTIONS)
def delayed_sample(inputs, first, last, j, place, by_place):
    """Return input j at a place among rows first..last, clamped to them, or its slope by the place.

    Cubic convolution (Keys 1981, IEEE Trans. ASSP 29, 1153, eq. (8)): exact for parabolas, so that what is moved in
    time is not smeared, and with a continuous slope, so that a search meets no kink.
    """
    left = int(place)
    f = place - left
    total = 0.0
    for m in range(4):
        value = inputs[min(max(left + m - 1, first), last - 1), j]
        near = abs(f + 1.0 - m)  # samples from the place to sample m of the four around it
        if by_place:
            side = 1.0 if f + 1.0 >= m else -1.0
            # derivatives of the weights below by the distance
            weight = side * (near * (4.5 * near - 5.0) if near < 1.0 else 5.0 * near - 1.5 * near**2 - 4.0)
        elif near < 1.0:
            weight = 1.0 + near**2 * (1.5 * near - 2.5)  # Keys, eq. (8)
        else:
            weight = 2.0 - near * (4.0 - near * (2.5 - 0.5 * near))  # Keys, eq. (8)
        total += weight * value
    return total


@njit(inline="always", **OPTIONS)
def effective_input(inputs, first, last, k, gain, offset, delay, dt, out):
    """Set out_j = gain_j * input_j(t_k - delay_j) + offset_j, clamped to rows first..last.

    The same number stands for an input that is held over the sample from t_k on: moved in time, its area, its first and
    its second moment stay what they are.
    """
    for j in range(out.size):
        if delay[j] == 0.0:
            raw = inputs[k, j]
        else:
            place = min(max(k - delay[j] / dt, first * 1.0), last - 1.0)
            raw = delayed_sample(inputs, first, last, j, place, False)
        out[j] = gain[j] * raw + offset[j]


@njit(inline="always", **OPTIONS)
def rk4_step(f, t, x, u0, um, u1, p, h, k1, k2, k3, k4, y):
    """Advance x in place by one step of length h; the rest is scratch. Returns the summed size of all stages.

    The running sum is the check for divergence; it also keeps these short loops scalar, as f stores scalars and a
    vector load behind scalar stores stalls (twice the time a step, measured).
    """
    n = x.size
    size = 0.0
    f(t, x, u0, p, k1)
    for i in range(n):
        y[i] = x[i] + 0.5 * h * k1[i]
        size += abs(y[i])
    f(t + 0.5 * h, y, um, p, k2)
    for i in range(n):
        y[i] = x[i] + 0.5 * h * k2[i]
        size += abs(y[i])
    f(t + 0.5 * h, y, um, p, k3)
    for i in range(n):
        y[i] = x[i] + h * k3[i]
        size += abs(y[i])
    f(t + h, y, u1, p, k4)
    for i in range(n):
        x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])  # weights of the classical scheme
        size += abs(x[i])
    return size


@kernel(
    void(
        *(FUNCTION, FUNCTION, MATRIX, TABLE, VECTOR, INDEX, I8, I8, F8, I8, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX),
        *(INDEX, MATRIX, INDEX),
        *(MATRIX, MATRIX, VECTOR),
    ),
    **LEAN,
)
def _replay(
    f, g, inputs, place, rise, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay, select, y_out,
    failed, work_x, work_u, g_value,
):  # fmt: skip
    nx, nu = x0.shape[1], inputs.shape[1]
    x, y, k1, k2, k3, k4 = work_x[0], work_x[1], work_x[2], work_x[3], work_x[4], work_x[5]
    u0, u1, um, ub = work_u[0], work_u[1], work_u[2], work_u[3]
    h = dt / substeps
    needs_g = False
    for i in range(select.size):
        needs_g = needs_g or select[i] >= nx
    for s in range(seg_from, seg_to):
        first, last = offsets[s], offsets[s + 1]
        for i in range(nx):
            x[i] = x0[s, i]
        par = p[s]
        gain_s, offset_s, delay_s = gain[s], offset[s], delay[s]
        here, low, high = place[s, 0], place[s, 1], place[s, 2]
        effective_input(inputs, low, high, here, gain_s, offset_s, delay_s, dt, u0)
        for row in range(first, last):
            t = (row - first) * dt
            if needs_g:
                g(t, x, u0, par, g_value)
            for i in range(select.size):
                y_out[row, i] = x[select[i]] if select[i] < nx else g_value[select[i] - nx]
            if row == last - 1:
                break
            effective_input(inputs, low, high, here + row + 1 - first, gain_s, offset_s, delay_s, dt, u1)
            size = 0.0
            for m in range(substeps):
                for j in range(nu):
                    half = 0.5 * rise[j] * (u1[j] - u0[j]) / (substeps - m)
                    um[j] = u0[j] + half
                    ub[j] = um[j] + half
                size += rk4_step(f, t + m * h, x, u0, um, ub, par, h, k1, k2, k3, k4, y)
                for j in range(nu):
                    u0[j] = ub[j] if rise[j] != 0.0 or m < substeps - 1 else u1[j]
            if not size < DIVERGED:
                failed[s] = row + 1 - first
                for late in range(row + 1, last):
                    for i in range(select.size):
                        y_out[late, i] = math.nan
                break


@kernel(void(FUNCTION, MATRIX, MATRIX, VECTOR, F8, MATRIX), **OPTIONS)
def evaluate(f, states, inputs, p, dt, out):
    """Evaluate f at every row of states and inputs: rates, outputs or bindings along a record."""
    for row in range(states.shape[0]):
        f(row * dt, states[row], inputs[row], p, out[row])


def replay(
    f, g, inputs, place, rise, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay, select, ng, y_out,
    failed,
):  # fmt: skip
    """Integrate segments seg_from..seg_to with recorded inputs; write selected outputs at every sample.

    Segment s owns rows offsets[s]..offsets[s+1] of y_out; place[s]: its first row in inputs, and the rows of its run
    there, first and behind the last, (segments, 3). rise (nu,): 1 for inputs that run straight from sample to sample, 0
    for those that are held. Outputs: index < nx is a state, nx + i is g_i.
    failed[s] becomes the sample at which the solution left all bounds (or was not finite), else stays -1.
    """
    nx, nu = x0.shape[1], inputs.shape[1]
    # scratch of a step: six rows of states, four of inputs
    _replay(f, g, inputs, place, rise, offsets, seg_from, seg_to, dt, substeps, x0, p, gain, offset, delay, select,
            y_out, failed, np.empty((6, nx)), np.empty((4, nu)), np.empty(max(ng, 1)))  # fmt: skip
