"""Innovations of a continuous-discrete extended Kalman filter, for any model.

Between samples the mean follows the Runge-Kutta scheme of `integrate`, its transition matrix the same scheme
differentiated (`sensitivity`); white process noise enters half before and half after (Strang splitting). Samples are
taken one scalar after the other (Jazwinski 1970, example 7.5; Bierman 1977, section II.6); NaN is no sample.

Sensitivities: of the mean by every column, of the covariance by the noise columns. By the other columns the covariance
counts as constant (gain frozen), which neglects terms of zero mean (Ljung 1999, section 10.2; Astrom 1980, section 5).
"""

import math

import numpy as np
from numba import njit

from seatrial.numerics.kernels.integrate import DIVERGED
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.sensitivity import propagate_tangent
from seatrial.numerics.kernels.types import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, TABLE, TANGENT, VECTOR


@njit(inline="always", **OPTIONS)
def propagate_covariance(transition, covariance, process, noisy_states, dt, work):
    """Set the covariance to Phi (P + Q/2) Phi' + Q/2: Phi the first columns of `transition`, Q = diag(process) dt.

    covariance[0] is P, the others its derivatives by the variances of the noisy states, then of the measurements.
    """
    nx = covariance.shape[1]
    for m in range(covariance.shape[0]):
        for half in range(2):
            if m == 0:
                for i in range(nx):
                    covariance[m, i, i] += 0.5 * process[i] * dt
            elif m <= noisy_states.size:
                i = noisy_states[m - 1]
                covariance[m, i, i] += 0.5 * dt
            if half == 1:
                break
            for i in range(nx):
                for j in range(nx):
                    total = 0.0
                    for k in range(nx):
                        total += transition[i, k] * covariance[m, k, j]
                    work[i, j] = total
            for i in range(nx):
                for j in range(i + 1):
                    total = 0.0
                    for k in range(nx):
                        total += work[i, k] * transition[j, k]
                    covariance[m, i, j] = total
                    covariance[m, j, i] = total


@kernel(
    I8(
        *(TANGENT, TANGENT, MATRIX, MATRIX, VECTOR, F8, I8, VECTOR, VECTOR, VECTOR),
        *(TABLE, TABLE, TABLE, TABLE, TABLE, INDEX, INDEX, VECTOR, VECTOR, MATRIX),
        *(MATRIX, MATRIX, CUBE, CUBE, MATRIX, MATRIX),
        *(MATRIX, CUBE, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR, CUBE, MATRIX, MATRIX),
    ),
    **LEAN,
)
def _filter_innovations(
    f, g, inputs, weights, rise, dt, substeps, x0, variance0, p,
    chain, link_p, link_u, g_link_p, g_link_u, select, noisy_states, process, measurement, measured,
    e_out, v_out, de_out, dv_out, variance_out, state_out,
    work_x, work_s, work_u, work_w, jac, g_jac, g_value, covariance, work, covariance_times_h,
):  # fmt: skip
    nx, ny, rows = x0.size, select.size, measured.shape[0]
    width, covs = de_out.shape[2], covariance.shape[0]
    quiet = width - (covs - 1)
    x, k, y, acc, ahead, h, gain = work_x[0], work_x[1], work_x[2], work_x[3], work_x[4], work_x[5], work_x[6]
    s, sk, sy, sacc = work_s[0], work_s[1], work_s[2], work_s[3]
    step = dt / substeps
    for i in range(nx):
        x[i], covariance[0, i, i] = x0[i], variance0[i]
    for row in range(rows):
        t = row * dt
        if variance_out.shape[0] > 0:
            for i in range(nx):
                variance_out[row, i] = covariance[0, i, i]
        if g_value.size > 0:
            g(t, x, inputs[row], p, g_value, g_jac)
            for i in range(nx):
                ahead[i] = x[i]
        size = 0.0
        for channel in range(ny):
            here = select[channel] - nx
            if math.isnan(measured[row, channel]):
                e_out[row, channel], v_out[row, channel] = 0.0, 1.0
                for c in range(width):
                    de_out[row, channel, c] = 0.0
                for m in range(1, covs):
                    dv_out[row, channel, m - 1] = 0.0
                continue
            e, v = measured[row, channel], measurement[channel]
            if here < 0:
                e -= x[here + nx]
                for i in range(nx):
                    h[i] = 1.0 if i == here + nx else 0.0
            else:
                e -= g_value[here]
                for i in range(nx):
                    h[i] = g_jac[here, i]
                    e -= h[i] * (x[i] - ahead[i])
            for m in range(covs):
                for i in range(nx):
                    total = 0.0
                    for j in range(nx):
                        total += covariance[m, i, j] * h[j]
                    covariance_times_h[m, i] = total
            for i in range(nx):
                v += h[i] * covariance_times_h[0, i]
            for i in range(nx):
                gain[i] = covariance_times_h[0, i] / v
            e_out[row, channel], v_out[row, channel] = e, v
            size += e * e / v
            for c in range(width):
                total = 0.0
                for i in range(nx):
                    total -= h[i] * s[i, nx + c]
                de_out[row, channel, c] = total
            if here >= 0:
                for m in range(g_link_p.shape[0]):
                    if g_link_p[m, 0] == here:
                        de_out[row, channel, g_link_p[m, 2] - nx] -= g_jac[here, g_link_p[m, 1]]
                for m in range(g_link_u.shape[0]):
                    if g_link_u[m, 0] == here:
                        de_out[row, channel, g_link_u[m, 3] - nx] -= (
                            g_jac[here, g_link_u[m, 1]] * weights[row, g_link_u[m, 2]]
                        )
            for i in range(nx):
                x[i] += gain[i] * e
                for c in range(width):
                    s[i, nx + c] += gain[i] * de_out[row, channel, c]
            for m in range(1, covs):
                dv = 1.0 if m - 1 - noisy_states.size == channel else 0.0
                for i in range(nx):
                    dv += h[i] * covariance_times_h[m, i]
                dv_out[row, channel, m - 1] = dv
                for i in range(nx):
                    s[i, nx + quiet + m - 1] += (covariance_times_h[m, i] - gain[i] * dv) * (e / v)
                    covariance_times_h[m, i] -= 0.5 * gain[i] * dv
            for i in range(nx):
                covariance_times_h[0, i] *= 0.5
            for m in range(covs):
                for i in range(nx):
                    for j in range(nx):
                        covariance[m, i, j] -= covariance_times_h[m, i] * gain[j] + gain[i] * covariance_times_h[m, j]
        if state_out.shape[0] > 0:
            for i in range(nx):
                state_out[row, i] = x[i]
        if row == rows - 1:
            break
        for i in range(nx):
            for j in range(nx):
                s[i, j] = 1.0 if i == j else 0.0
        for m in range(substeps):
            for place in range(3):
                part = (m + 0.5 * place) / substeps
                for j in range(inputs.shape[1]):
                    work_u[place, j] = inputs[row, j] + rise[j] * part * (inputs[row + 1, j] - inputs[row, j])
                for j in range(weights.shape[1]):
                    going = rise[j // 3] * part  # three weights an input
                    work_w[place, j] = weights[row, j] + going * (weights[row + 1, j] - weights[row, j])
            for i in range(nx):
                y[i], acc[i] = x[i], 0.0
                for c in range(nx + width):
                    sy[i, c], sacc[i, c] = s[i, c], 0.0
            for stage in range(4):  # as `rk4_tangent_step`, but a loop: a third of the code to compile
                place = (stage + 1) // 2
                f(t + (m + 0.5 * place) * step, y, work_u[place], p, k, jac)
                propagate_tangent(jac, chain, link_p, link_u, work_w[place], sy, sk)
                weight = step / 6.0 if place != 1 else step / 3.0  # weights of the Runge-Kutta method of order 4
                ahead_by = step if stage == 2 else 0.5 * step
                for i in range(nx):
                    acc[i] += weight * k[i]
                    y[i] = x[i] + ahead_by * k[i]
                    size += abs(y[i])
                    for c in range(nx + width):
                        sacc[i, c] += weight * sk[i, c]
                        sy[i, c] = s[i, c] + ahead_by * sk[i, c]
            for i in range(nx):
                x[i] += acc[i]
                for c in range(nx + width):
                    s[i, c] += sacc[i, c]
        propagate_covariance(s, covariance, process, noisy_states, dt, work)
        if not size < DIVERGED:
            return row + 1
    return -1


def filter_innovations(
    f, g, inputs, weights, rise, dt, substeps, x0, variance0, p,
    chain, link_p, link_u, g_link_p, g_link_u, select, ng, noisy_states, process, measurement, measured,
    e_out, v_out, de_out, dv_out, variance_out, state_out,
):  # fmt: skip
    """Filter one run: innovations e_out (measured - predicted) and their variances v_out, (rows, ny).

    Return the sample before which the solution left all bounds, the rest being unwritten, or -1.

    inputs (rows, nu), corrected; weights (rows, 3 nu), their derivatives by offset, gain and delay, or (rows, 0) where
    no column needs them; rise (nu,): 1 for inputs that run straight from sample to sample, 0 for those that are held;
    x0, variance0 (nx,): mean and variance of the initial state. process: variance a second of each state's white
    noise, (nx,); measurement: variance of each channel, (ny,). de_out (rows, ny, columns):
    sensitivities of e, columns as the links say (counted from nx, the first nx being the transition matrix), the last
    ones by process of `noisy_states` and by measurement; dv_out (rows, ny, noise columns) those of v; without columns
    the likelihood alone. variance_out (rows or 0, nx): of the states before each sample; state_out (rows or 0,
    nx): their means after it. A missing sample has e = 0 and v = 1.
    """
    nx, nu, width = x0.size, inputs.shape[1], de_out.shape[2]
    whole, covs = nx + nu + p.size, 1 + dv_out.shape[2]
    outputs = ng if np.any(select >= nx) else 0
    return _filter_innovations(f, g, inputs, weights, rise, dt, substeps, x0, variance0, p,
                     chain, link_p, link_u, g_link_p, g_link_u, select, noisy_states, process, measurement, measured,
                     e_out, v_out, de_out, dv_out, variance_out, state_out,
                     np.empty((7, nx)),  # 7 vectors of states, taken apart at the kernel's head
                     np.zeros((4, nx, nx + width)), np.empty((3, nu)), np.empty((3, 3 * nu)),
                     np.zeros((nx, whole)), np.zeros((outputs, whole)), np.empty(outputs), np.zeros((covs, nx, nx)),
                     np.empty((nx, nx)), np.empty((covs, nx)))  # fmt: skip
