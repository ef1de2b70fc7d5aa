"""Fixed-step Runge-Kutta integration of any model with replayed inputs, and its exact discrete sensitivities."""

import math

import numpy as np
from numba import njit, types, void

from seatrial.numerics.kernels.kernel import (
    CUBE,
    F8,
    FUNCTION,
    I8,
    INDEX,
    LEAN,
    MATRIX,
    OPTIONS,
    TABLE,
    TANGENT,
    VECTOR,
    kernel,
)
from seatrial.numerics.kernels.simd import LANES, add_multiple, aligned_scratch, gather_scaled

# Sine and cosine of one angle together, inlined into the generated code: two for less than the price of one call.

_TWO_OVER_PI = 2.0 / math.pi
# pi/2 in three parts, the first two of 33 bits, so that k times them is exact (Cody & Waite 1980, chapter 8)
HALF_PI = (1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
_HALF_PI_1, _HALF_PI_2, _HALF_PI_3 = HALF_PI

# coefficients of the Taylor series of the sine to the 17th power and the cosine to the 18th: rounding at pi/4
SINE_SERIES = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in range(1, 9))
COSINE_SERIES = tuple((-1.0) ** k / math.factorial(2 * k) for k in range(1, 10))
_S, _C = SINE_SERIES, COSINE_SERIES


@kernel(types.UniTuple(F8, 2)(F8), **OPTIONS)
def sincos(angle: float) -> tuple[float, float]:
    """Return (sin, cos) within 1e-16 for |angle| < 1e5 rad; Taylor polynomials on |r| <= pi/4, by Estrin's scheme."""
    k = math.floor(angle * _TWO_OVER_PI + 0.5)
    r = ((angle - k * _HALF_PI_1) - k * _HALF_PI_2) - k * _HALF_PI_3
    z = r * r
    z2 = z * z
    z4 = z2 * z2
    low = (_S[0] + z * _S[1]) + z2 * (_S[2] + z * _S[3])
    s = r + r * z * (low + z4 * ((_S[4] + z * _S[5]) + z2 * (_S[6] + z * _S[7])))
    low = (_C[0] + z * _C[1]) + z2 * (_C[2] + z * _C[3])
    c = 1.0 + z * (low + z4 * ((_C[4] + z * _C[5]) + z2 * (_C[6] + z * (_C[7] + z * _C[8]))))
    quadrant = k - 4.0 * math.floor(0.25 * k)
    swapped = quadrant == 1.0 or quadrant == 3.0
    first = c if swapped else s
    second = s if swapped else c
    return first if quadrant < 2.0 else -first, second if quadrant == 0.0 or quadrant == 3.0 else -second


# The cubic spline through evenly spaced samples: its slopes, of which each piece is made, and points between.


@njit(inline="always", **OPTIONS)
def _spline_slopes(u, slope, work):
    n = u.shape[0]
    for j in range(u.shape[1]):
        if n < 4:
            rise = 0.0 if n == 1 else (u[n - 1, j] - u[0, j]) / (n - 1)
            bend = 0.0 if n < 3 else u[2, j] - 2.0 * u[1, j] + u[0, j]
            for i in range(n):
                slope[i, j] = rise + (i - 1) * bend
            continue
        before, after = u[1, j] - u[0, j], u[2, j] - u[1, j]
        work[0] = 2.0
        slope[0, j] = 2.5 * before + 0.5 * after  # not-a-knot: s0 + 2 s1 = 5/2 and 1/2 of the first two rises
        for i in range(1, n - 1):
            after = u[i + 1, j] - u[i, j]
            pivot = 1.0 / (4.0 - work[i - 1])
            work[i] = pivot
            slope[i, j] = (3.0 * (before + after) - slope[i - 1, j]) * pivot
            before = after
        last = 2.5 * before + 0.5 * (u[n - 2, j] - u[n - 3, j])  # not-a-knot, as at the first end
        slope[n - 1, j] = (last - 2.0 * slope[n - 2, j]) / (1.0 - 2.0 * work[n - 2])
        for i in range(n - 2, -1, -1):
            slope[i, j] -= work[i] * slope[i + 1, j]


@kernel(void(MATRIX, MATRIX, VECTOR), **LEAN)
def _slopes(u, slope, work):
    _spline_slopes(u, slope, work)


@kernel(void(MATRIX, I8, MATRIX, MATRIX, VECTOR), **LEAN)
def _latest_slopes(u, history, latest, slope, work):
    nu = u.shape[1]
    for row in range(1, u.shape[0]):
        first = max(row - history, 0)
        _spline_slopes(u[first : row + 1], slope, work)
        for j in range(nu):
            latest[row, j], latest[row, nu + j] = slope[row - first - 1, j], slope[row - first, j]


def latest_slopes(u, history):
    """Return slopes at each row of u (n, columns) and at the one before it, of the spline through rows up to it alone.

    history: rows before it that count. (n, 2 columns): first those of the row before; nothing of the first row.
    """
    latest = np.zeros((len(u), 2 * u.shape[1]))
    _latest_slopes(u, history, latest, np.empty((history + 1, u.shape[1])), np.empty(history + 1))
    return latest


def spline_slopes(u):
    """Return the slope per sample of the not-a-knot cubic spline through u (n, columns), as SciPy's `CubicSpline`.

    Equal steps: s[i-1] + 4 s[i] + s[i+1] = 3 (u[i+1] - u[i-1]) (de Boor 1978, chapter IV). What lies m samples ahead
    acts on a slope by (2 - sqrt 3)^m of its own, so that a few samples ahead do for a whole record.
    """
    slope = np.empty_like(u)
    _slopes(u, slope, np.empty(len(u)))
    return slope


@kernel(void(MATRIX, MATRIX, VECTOR, MATRIX, MATRIX), **LEAN)
def _points(u, slope, place, value, rise):
    last = max(u.shape[0] - 2, 0)
    for k in range(len(place)):
        i = min(int(place[k]), last)
        following, s = min(i + 1, u.shape[0] - 1), place[k] - i
        for j in range(u.shape[1]):
            step = u[following, j] - u[i, j]
            c2 = 3.0 * step - 2.0 * slope[i, j] - slope[following, j]
            c3 = slope[i, j] + slope[following, j] - 2.0 * step
            value[k, j] = u[i, j] + s * (slope[i, j] + s * (c2 + s * c3))
            rise[k, j] = slope[i, j] + s * (2.0 * c2 + s * 3.0 * c3)


def spline_points(u, slope, place):
    """Return the spline through u (n, columns) with these slopes per sample at each place, and its rate per sample.

    place: counted in samples, within 0 and n - 1, (k,). Both results are (k, columns); cubic Hermite pieces (de Boor
    1978, chapter IV, eq. 2).
    """
    value, rise = np.empty((len(place), u.shape[1])), np.empty((len(place), u.shape[1]))
    _points(u, slope, place, value, rise)
    return value, rise


# Fixed-step Runge-Kutta integration of any model with replayed inputs, held or straight between samples.

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


# Trajectories with exact discrete sensitivities: the Runge-Kutta scheme differentiated stage by stage.

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
