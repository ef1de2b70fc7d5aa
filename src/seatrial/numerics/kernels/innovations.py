"""Innovations of a continuous-discrete extended Kalman filter, for any model.

Between samples the mean follows the Runge-Kutta scheme of `integrate`, its transition matrix the same scheme
differentiated (`sensitivity`); white process noise enters half before and half after (Strang splitting). Samples are
taken one scalar after the other (Jazwinski 1970, example 7.5; Bierman 1977, section II.6), each by the few states that
it shows and on the lower triangles of covariances; NaN is no sample.

Behind the craft's states stand pairs of states of first-order wave motion, a displacement and its rate, which channels
show on top of the craft's own motion. They are linear and apart from the craft, so that each has its exact block of
two, whatever the time step.

A channel may have been turned by the reading of another, as velocities over ground are by the heading shown: the error
of that reading is then in both. Such a sample is taken together with a multiple of the other channel's, in which the
error cancels; the determinant of this change of samples is 1 (a noise of full covariance made diagonal; Bierman 1977,
section III.3), so that the likelihood is that of the samples themselves.

Sensitivities: of the mean by every column, of the covariance by the noise columns. By the other columns the covariance
counts as constant (gain frozen), which neglects terms of zero mean (Ljung 1999, section 10.2; Astrom 1980, section 5).
"""

import math

import numpy as np
from numba import njit

from seatrial.numerics.kernels.integrate import DIVERGED, propagate_tangent
from seatrial.numerics.kernels.kernel import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, TABLE, TANGENT, VECTOR, kernel

PHI, NOISE, SQUARED_FREQUENCY = 0, 12, 21
"""Columns of a pair: its transition matrix and derivatives by frequency and damping, four each; the variance that it
gains in a step and its derivatives, three each; the square of its frequency."""


@njit(inline="always", **OPTIONS)
def add_pair(covariance, a, pair, place, factor):
    """Add factor times the symmetric block of two at `place` to the covariance, from row a."""
    covariance[a, a] += factor * pair[place]
    covariance[a, a + 1] += factor * pair[place + 1]
    covariance[a + 1, a] += factor * pair[place + 1]
    covariance[a + 1, a + 1] += factor * pair[place + 2]


@njit(inline="always", **OPTIONS)
def turn_pair(covariance, m, a, pairs, q, place, transition, nx, turned):
    """Add dPhi P Phi' and its transpose to covariance[m], dPhi: the block at `place` of pair q, P: covariance[0]."""
    n = covariance.shape[1]
    for row in range(2):
        for j in range(n):
            turned[j] = (
                pairs[q, place + 2 * row] * covariance[0, a, j]
                + pairs[q, place + 2 * row + 1] * covariance[0, a + 1, j]
            )
        for j in range(n):
            total = 0.0
            if j < nx:
                for k in range(nx):
                    total += turned[k] * transition[j, k]
            else:
                b, other = j - (j - nx) % 2, (j - nx) // 2
                column = PHI + 2 * ((j - nx) % 2)
                total = pairs[other, column] * turned[b] + pairs[other, column + 1] * turned[b + 1]
            covariance[m, a + row, j] += total
            covariance[m, j, a + row] += total


@njit(inline="always", **OPTIONS)
def propagate_covariance(transition, nx, pairs, size, peaks, covariance, process, noisy_states, dt, work):
    """Set the covariance to Phi (P + Q/2) Phi' + Q/2 of the craft's states, to Phi P Phi' + Q of those of waves.

    Its lower triangle comes in, the whole goes out. covariance[0] is P, the others its derivatives by the variances of
    the noisy states, then by frequency and damping of each peak, by the variances of the pairs, by those of the
    measurements. Phi has the craft's block, the first nx rows and columns of `transition`, then a block of two for each
    pair. The last derivatives come first: those by frequency and damping need P as it was.
    """
    n = covariance.shape[1]
    shapes, sizes = 1 + noisy_states.size, 1 + noisy_states.size + 2 * peaks
    for m in range(covariance.shape[0]):
        for i in range(n):
            for j in range(i):
                covariance[m, j, i] = covariance[m, i, j]
    for m in range(covariance.shape[0] - 1, -1, -1):
        for half in range(2):
            if m == 0:
                for i in range(nx):
                    covariance[m, i, i] += 0.5 * process[i] * dt
            elif m < shapes:
                i = noisy_states[m - 1]
                covariance[m, i, i] += 0.5 * dt
            if half == 1:
                break
            for i in range(nx):
                for j in range(n):
                    work[i, j] = 0.0
                for k in range(nx):
                    if transition[i, k] != 0.0:
                        for j in range(n):
                            work[i, j] += transition[i, k] * covariance[m, k, j]
            for i in range(nx, n):
                a, q = i - (i - nx) % 2, (i - nx) // 2
                column = PHI + 2 * ((i - nx) % 2)
                for j in range(n):
                    work[i, j] = pairs[q, column] * covariance[m, a, j] + pairs[q, column + 1] * covariance[m, a + 1, j]
            for i in range(n):
                for j in range(i + 1):
                    total = 0.0
                    if j < nx:
                        for k in range(nx):
                            total += work[i, k] * transition[j, k]
                    else:
                        b, q = j - (j - nx) % 2, (j - nx) // 2
                        column = PHI + 2 * ((j - nx) % 2)
                        total = pairs[q, column] * work[i, b] + pairs[q, column + 1] * work[i, b + 1]
                    covariance[m, i, j] = total
                    covariance[m, j, i] = total
        if m == 0:
            for q in range(size.size):
                add_pair(covariance[m], nx + 2 * q, pairs[q], NOISE, size[q])
        elif shapes <= m < sizes:
            slope, each = (m - shapes) % 2, size.size // peaks
            for q in range((m - shapes) // 2 * each, ((m - shapes) // 2 + 1) * each):
                turn_pair(covariance, m, nx + 2 * q, pairs, q, PHI + 4 * (slope + 1), transition, nx, work[0])
                add_pair(covariance[m], nx + 2 * q, pairs[q], NOISE + 3 * (slope + 1), size[q])
        elif sizes <= m < sizes + size.size:
            add_pair(covariance[m], nx + 2 * (m - sizes), pairs[m - sizes], NOISE, 1.0)


@njit(inline="always", **OPTIONS)
def begin_pairs(covariance, nx, pairs, size, first, peaks):
    """Set the blocks of the pairs to their stationary variances, size and size omega^2, and to their derivatives.

    first: the covariance that is the derivative by the frequency of the first peak.
    """
    for q in range(size.size):
        a, square = nx + 2 * q, pairs[q, SQUARED_FREQUENCY]
        covariance[0, a, a], covariance[0, a + 1, a + 1] = size[q], size[q] * square
        if covariance.shape[0] > 1:
            covariance[first + q // (size.size // peaks) * 2, a + 1, a + 1] = 2.0 * math.sqrt(square) * size[q]
            covariance[first + 2 * peaks + q, a, a], covariance[first + 2 * peaks + q, a + 1, a + 1] = 1.0, square


@njit(inline="always", **OPTIONS)
def turn_waves(x, s, nx, pairs, first, size, peaks):
    """Advance the waves' states and their sensitivities; first: column of s by the frequency of the first peak."""
    for q in range(size.size):
        a = nx + 2 * q
        p00, p01, p10, p11 = pairs[q, PHI], pairs[q, PHI + 1], pairs[q, PHI + 2], pairs[q, PHI + 3]
        for c in range(nx, s.shape[1]):
            s[a, c], s[a + 1, c] = p00 * s[a, c] + p01 * s[a + 1, c], p10 * s[a, c] + p11 * s[a + 1, c]
        if s.shape[1] > nx:
            column = first + q // (size.size // peaks) * 2
            for slope in range(2):
                place = PHI + 4 * (slope + 1)
                s[a, column + slope] += pairs[q, place] * x[a] + pairs[q, place + 1] * x[a + 1]
                s[a + 1, column + slope] += pairs[q, place + 2] * x[a] + pairs[q, place + 3] * x[a + 1]
        x[a], x[a + 1] = p00 * x[a] + p01 * x[a + 1], p10 * x[a] + p11 * x[a + 1]


@kernel(
    I8(
        *(TANGENT, TANGENT, MATRIX, MATRIX, VECTOR, F8, I8, VECTOR, VECTOR, VECTOR),
        *(TABLE, TABLE, TABLE, TABLE, TABLE, INDEX, INDEX, VECTOR, VECTOR, MATRIX),
        *(MATRIX, VECTOR, TABLE, I8, MATRIX),
        *(MATRIX, MATRIX, CUBE, CUBE, MATRIX, MATRIX),
        *(MATRIX, CUBE, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR, CUBE, MATRIX, MATRIX, INDEX),
    ),
    **LEAN,
)
def _filter_innovations(
    f, g, inputs, weights, rise, dt, substeps, x0, variance0, p,
    chain, link_p, link_u, g_link_p, g_link_u, select, noisy_states, process, measurement, measured,
    pairs, size, wave_states, turned_by, turning, e_out, v_out, de_out, dv_out, variance_out, state_out,
    work_x, work_s, work_u, work_w, jac, g_jac, g_value, covariance, work, covariance_times_h, places,
):  # fmt: skip
    nx, ny, rows, peaks = x0.size, select.size, measured.shape[0], wave_states.shape[1]
    width, covs, n = de_out.shape[2], covariance.shape[0], x0.size + 2 * size.size
    quiet, measurements = width - (covs - 1), 1 + noisy_states.size + 2 * peaks + size.size
    x, k, y, acc, ahead, h, gain = work_x[0], work_x[1], work_x[2], work_x[3], work_x[4], work_x[5], work_x[6]
    s, sk, sy, sacc = work_s[0], work_s[1], work_s[2], work_s[3]
    step = dt / substeps
    for i in range(nx):
        x[i], covariance[0, i, i] = x0[i], variance0[i]
    for i in range(nx, n):
        x[i] = 0.0
    begin_pairs(covariance, nx, pairs, size, 1 + noisy_states.size, peaks)
    for row in range(rows):
        t = row * dt
        if variance_out.shape[0] > 0:
            for i in range(nx):
                variance_out[row, i] = covariance[0, i, i]
        if g_value.size > 0:
            g(t, x, inputs[row], p, g_value, g_jac)
            for i in range(nx):
                ahead[i] = x[i]
        magnitude = 0.0
        for channel in range(ny):
            if math.isnan(measured[row, channel]):
                e_out[row, channel], v_out[row, channel] = 0.0, 1.0
                for c in range(width):
                    de_out[row, channel, c] = 0.0
                for m in range(1, covs):
                    dv_out[row, channel, m - 1] = 0.0
                continue
            e, v = 0.0, measurement[channel]
            count, terms = 0, 1 if turning[row, channel] == 0.0 else 2
            for term in range(terms):
                other, factor = (channel, 1.0) if term == 0 else (turned_by, turning[row, channel])
                here = select[other] - nx
                e += factor * measured[row, other]
                if here < 0:
                    e -= factor * x[here + nx]
                    places[count], h[count] = here + nx, factor
                    count += 1
                    continue
                e -= factor * g_value[here]
                for i in range(nx):
                    if g_jac[here, i] != 0.0:
                        e -= factor * g_jac[here, i] * (x[i] - ahead[i])
                        places[count], h[count] = i, factor * g_jac[here, i]
                        count += 1
            for peak in range(peaks):
                if wave_states[channel, peak] >= 0:
                    e -= x[wave_states[channel, peak]]
                    places[count], h[count] = wave_states[channel, peak], 1.0
                    count += 1
            for m in range(covs):
                for i in range(n):
                    covariance_times_h[m, i] = 0.0
                for a in range(count):
                    j = places[a]
                    for i in range(j):
                        covariance_times_h[m, i] += covariance[m, j, i] * h[a]
                    for i in range(j, n):
                        covariance_times_h[m, i] += covariance[m, i, j] * h[a]
            for a in range(count):
                v += h[a] * covariance_times_h[0, places[a]]
            for i in range(n):
                gain[i] = covariance_times_h[0, i] / v
            e_out[row, channel], v_out[row, channel] = e, v
            magnitude += e * e / v
            for c in range(width):
                total = 0.0
                for a in range(count):
                    total -= h[a] * s[places[a], nx + c]
                de_out[row, channel, c] = total
            for term in range(terms):
                other, factor = (channel, 1.0) if term == 0 else (turned_by, turning[row, channel])
                here = select[other] - nx
                if here < 0:
                    continue
                for m in range(g_link_p.shape[0]):
                    if g_link_p[m, 0] == here:
                        de_out[row, channel, g_link_p[m, 2] - nx] -= factor * g_jac[here, g_link_p[m, 1]]
                for m in range(g_link_u.shape[0]):
                    if g_link_u[m, 0] == here:
                        de_out[row, channel, g_link_u[m, 3] - nx] -= (
                            factor * g_jac[here, g_link_u[m, 1]] * weights[row, g_link_u[m, 2]]
                        )
            for i in range(n):
                x[i] += gain[i] * e
                for c in range(width):
                    s[i, nx + c] += gain[i] * de_out[row, channel, c]
            for m in range(1, covs):
                dv = 1.0 if m - measurements == channel else 0.0
                for a in range(count):
                    dv += h[a] * covariance_times_h[m, places[a]]
                dv_out[row, channel, m - 1] = dv
                for i in range(n):
                    s[i, nx + quiet + m - 1] += (covariance_times_h[m, i] - gain[i] * dv) * (e / v)
                    covariance_times_h[m, i] -= 0.5 * gain[i] * dv
            for i in range(n):
                covariance_times_h[0, i] *= 0.5
            for m in range(covs):
                for i in range(n):
                    for j in range(i + 1):
                        covariance[m, i, j] -= covariance_times_h[m, i] * gain[j] + gain[i] * covariance_times_h[m, j]
        if state_out.shape[0] > 0:
            for i in range(n):
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
                    magnitude += abs(y[i])
                    for c in range(nx + width):
                        sacc[i, c] += weight * sk[i, c]
                        sy[i, c] = s[i, c] + ahead_by * sk[i, c]
            for i in range(nx):
                x[i] += acc[i]
                for c in range(nx + width):
                    s[i, c] += sacc[i, c]
        propagate_covariance(s, nx, pairs, size, peaks, covariance, process, noisy_states, dt, work)
        turn_waves(x, s, nx, pairs, nx + quiet + noisy_states.size, size, peaks)
        if not magnitude < DIVERGED:
            return row + 1
    return -1


def filter_innovations(
    f, g, inputs, weights, rise, dt, substeps, x0, variance0, p,
    chain, link_p, link_u, g_link_p, g_link_u, select, ng, noisy_states, process, measurement, measured,
    pairs, size, wave_states, turned_by, turning, e_out, v_out, de_out, dv_out, variance_out, state_out,
):  # fmt: skip
    """Filter one run: innovations e_out (measured - predicted) and their variances v_out, (rows, ny).

    Return the sample before which the solution left all bounds, the rest being unwritten, or -1.

    inputs (rows, nu), corrected; weights (rows, 3 nu), their derivatives by offset, gain and delay, or (rows, 0) where
    no column needs them; rise (nu,): 1 for inputs that run straight from sample to sample, 0 for those that are held;
    x0, variance0 (nx,): mean and variance of the initial state. process: variance a second of each state's white noise,
    (nx,); measurement: variance of each channel, (ny,). Waves: pairs (k, 22), the same number of each peak, peak after
    peak; size (k,), variance of each displacement; wave_states (ny, peaks), the state behind the craft's that a channel
    shows of each peak, -1 for none. turning (rows, ny): multiple of channel `turned_by` by which a sample is taken
    together with it, 0 for a sample alone; the waves that `turned_by` shows are no part of it. de_out (rows, ny,
    columns): sensitivities of e, columns as the links say (counted from nx, the first nx being the transition matrix),
    the last ones by process of `noisy_states`, by frequency and damping of each peak, by sizes, by measurement; dv_out
    (rows, ny, noise columns) those of v; without columns the likelihood alone. variance_out (rows or 0, nx): of the
    craft's states before each sample; state_out (rows or 0, nx + 2 k): means of all after it. A missing sample has e =
    0 and v = 1.
    """
    nx, nu, width = x0.size, inputs.shape[1], de_out.shape[2]
    whole, covs, n = nx + nu + p.size, 1 + dv_out.shape[2], nx + 2 * size.size
    outputs = ng if np.any(select >= nx) else 0
    return _filter_innovations(f, g, inputs, weights, rise, dt, substeps, x0, variance0, p,
                     chain, link_p, link_u, g_link_p, g_link_u, select, noisy_states, process, measurement, measured,
                     pairs, size, wave_states, turned_by, turning,
                     e_out, v_out, de_out, dv_out, variance_out, state_out,
                     np.empty((7, 2 * n)),  # 7 vectors, taken apart at the kernel's head; one of two channels
                     np.zeros((4, n, nx + width)), np.empty((3, nu)), np.empty((3, 3 * nu)),
                     np.zeros((nx, whole)), np.zeros((outputs, whole)), np.empty(outputs), np.zeros((covs, n, n)),
                     np.empty((n, n)), np.empty((covs, n)), np.empty(2 * n, dtype=np.int64))  # fmt: skip
