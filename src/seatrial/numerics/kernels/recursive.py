"""Coefficients and state of a run without process noise, estimated as samples come, as square roots."""

import math

import numpy as np
from numba import njit, void

from seatrial.numerics.kernels.integrate import DIVERGED, rk4_tangent_step
from seatrial.numerics.kernels.kernel import CUBE, F8, I8, INDEX, LEAN, MATRIX, OPTIONS, TABLE, TANGENT, VECTOR, kernel
from seatrial.numerics.kernels.simd import LANES

# A Gaussian estimate kept as a square root: covariance P = R R', R square, not triangular.

ALIKE = 2
"""Of the four innovations before one beyond the limit, at least, that are near it, or it is a spike: with it they are
most of five (chosen)."""

# what `update_sample` counts, by channel: measurements used, outliers among them
USED, OUTLIERS = 0, 1


@njit(inline="always", **OPTIONS)
def project_root(root, h, v):
    """Set v = R' h and return its square, the variance of h' z."""
    n = h.size
    for j in range(n):
        v[j] = 0.0
    for i in range(n):
        a = h[i]
        if a != 0.0:
            for j in range(n):
                v[j] += a * root[i, j]
    total = 0.0
    for j in range(n):
        total += v[j] * v[j]
    return total


@njit(inline="always", **OPTIONS)
def update_scalar(root, z, v, predicted_variance, variance, e):
    """Update by a measurement of this variance, e beyond its prediction; v and its variance: of `project_root`."""
    n = z.size
    total = predicted_variance + variance
    shrink = 1.0 / (total + math.sqrt(variance * total))
    for i in range(n):
        w = 0.0
        for j in range(n):
            w += root[i, j] * v[j]
        z[i] += w * (e / total)
        w *= shrink
        for j in range(n):
            root[i, j] -= w * v[j]


@njit(inline="always", **OPTIONS)
def update_jumps(root, h, v, total, e, weight, effects, information, score, innovation_effects):
    """Take in an innovation e of variance `total` = h' P h + r, v = R' h, before `update_scalar` does.

    A jump of relative size d at instant m moves the error of z by effects_m d, so that an innovation moves by
    h' effects_m d: score += g e / total, information += g g' / total, g = effects_m' h, and effects_m -= K g', K the
    gain (Willsky & Jones 1976, IEEE Trans. AC 21, 108). weight: 0 where it says nothing of a jump. effects (n, m k),
    information (m, k, k), score (m, k), innovation_effects (m k,).
    """
    k = score.shape[1]
    for c in range(innovation_effects.size):
        innovation_effects[c] = 0.0
    for i in range(h.size):
        if h[i] != 0.0:
            for c in range(innovation_effects.size):
                innovation_effects[c] += h[i] * effects[i, c]
    for m in range(score.shape[0]):
        for a in range(k):
            g = weight * innovation_effects[m * k + a] / total
            score[m, a] += g * e
            for b in range(k):
                information[m, a, b] += g * innovation_effects[m * k + b]
    for i in range(h.size):
        gain = 0.0
        for j in range(h.size):
            gain += root[i, j] * v[j]
        gain /= total
        for c in range(innovation_effects.size):
            effects[i, c] -= gain * innovation_effects[c]


@njit(inline="always", **OPTIONS)
def resembling(latest, e, distance):
    """Return how many of the latest innovations are within a distance of e, which then is the first of them."""
    near, following = 0, e
    for lag in range(latest.size):
        if abs(latest[lag] - e) <= distance:
            near += 1
        latest[lag], following = following, latest[lag]
    return near


@njit(inline="always", **OPTIONS)
def update_sample(
    root, z, z_reference, h, predicted, measured, variance, huber_limit, memory, running_means, counts, v,
    effects, information, score, innovation_effects, latest,
):  # fmt: skip
    """Update by all channels of one sample, NaN being no measurement.

    h (ny, n), predicted (ny,): slopes and values at z_reference. An innovation beyond `huber_limit` standard deviations
    counts linearly (Huber 1964): its variance is raised as far as its weight falls, and what moves z ends at the limit.
    running_means (ny, 2): over the latest `memory` of the squared innovation, by its variance and plain, cut at the
    limit; counts (2, ny). effects to innovation_effects: see `update_jumps`, no columns where no jump is looked for.
    latest (ny, 4): innovations before; one beyond the limit that fewer than `ALIKE` of them resemble is no jump's.
    """
    n = z.size
    for channel in range(variance.size):
        e = measured[channel] - predicted[channel]
        if math.isnan(e):
            continue
        for j in range(n):
            e -= h[channel, j] * (z[j] - z_reference[j])
        spread = project_root(root, h[channel], v)
        r = variance[channel]
        size = math.sqrt(e * e / (spread + r))
        counts[USED, channel] += 1
        cut = 1.0
        if size > huber_limit:
            counts[OUTLIERS, channel] += 1
            cut = huber_limit / size
        weight = 1.0 / min(counts[USED, channel] * 1.0, memory)
        running_means[channel, 0] += weight * ((cut * size) ** 2 - running_means[channel, 0])
        running_means[channel, 1] += weight * ((cut * e) ** 2 - running_means[channel, 1])
        near = resembling(latest[channel], e, huber_limit * math.sqrt(spread + r))
        tells = 1.0 if cut == 1.0 or near >= ALIKE else 0.0
        r /= cut
        most = huber_limit * math.sqrt(spread + r)
        e = min(max(e, -most), most)
        if innovation_effects.size > 0:
            update_jumps(root, h[channel], v, spread + r, e, tells, effects, information, score, innovation_effects)
        update_scalar(root, z, v, spread, r, e)


@njit(inline="always", **OPTIONS)
def forget(root, z, floor_root, forgetting_factor, v):
    """Take the geometric mean of the estimate (power f) and a wide one about the same point (power 1 - f).

    Information <- f * information + (1 - f) * floor_root' floor_root, f the forgetting factor: exponential forgetting
    that ends at the wide estimate where nothing is learnt (Kulhavy & Zarrop 1993, section 3). floor_root (rows, n).
    """
    n = z.size
    grown = math.sqrt(1.0 / forgetting_factor)
    for i in range(n):
        for j in range(n):
            root[i, j] *= grown
    for m in range(floor_root.shape[0]):
        spread = project_root(root, floor_root[m], v)
        update_scalar(root, z, v, spread, 1.0 / (1.0 - forgetting_factor), 0.0)


# Coefficients and state of a run without process noise, estimated as the samples come.

_GAUSSIAN_STATE = (VECTOR, MATRIX)
_SAMPLES = (MATRIX, MATRIX, I8, I8)
_NOISE = (VECTOR, F8, F8, MATRIX, TABLE)
_FORGETTING = (MATRIX, F8, I8, INDEX)
_JUMPS = (MATRIX, CUBE, MATRIX, VECTOR, MATRIX, MATRIX)
_SCRATCH = (VECTOR, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX)


@njit(inline="always", **OPTIONS)
def _propagate(columns, step, k, work):
    """Propagate the state rows of columns (k + nx, any) through a step with the derivatives `step` (nx, k + nx)."""
    nx, n = step.shape
    for i in range(nx):
        for j in range(columns.shape[1]):
            work[i, j] = 0.0
        for m in range(n):
            a = step[i, m]
            if a != 0.0:
                for j in range(columns.shape[1]):
                    work[i, j] += a * columns[m, j]
    for i in range(nx):
        for j in range(columns.shape[1]):
            columns[k + i, j] = work[i, j]


@njit(inline="always", **OPTIONS)
def _forget_when_due(root, z, floor_root, forgetting_factor, forget_every, samples_since, v):
    samples_since[0] += 1
    if forgetting_factor < 1.0 and samples_since[0] >= forget_every:
        forget(root, z, floor_root, forgetting_factor, v)
        samples_since[0] = 0


@kernel(
    I8(
        *(CUBE, CUBE, CUBE, CUBE, MATRIX, MATRIX, VECTOR),
        *(*_GAUSSIAN_STATE, *_SAMPLES, MATRIX, *_NOISE, *_FORGETTING, *_JUMPS, *_SCRATCH, VECTOR, VECTOR),
    ),
    **LEAN,
)
def filter_linear(
    de, dg, dc, dd, step_matrix, output_matrix, expansion_point, z, root, inputs, measured, first_row, is_run_start,
    slopes, variance, limit, memory, running_means, counts, floor_root, forgetting_factor, forget_every,
    samples_since, effects, information, score, innovation_effects, latest, moved, v, z_reference, predicted, h, step,
    work, w, x,
):  # fmt: skip
    """Process rows first_row.. of an affine model; return the row at which the state left all bounds, or -1.

    step_matrix (nx, nx + nw), output_matrix (ny, nx + nu + 1): the step and the outputs at `expansion_point`, columns
    state, then inputs; their derivatives by the coefficients, last axis: de (nx, nx, k), dg (nx, nw, k), dc (ny, nx,
    k), dd (ny, nu + 1, k). nw = 4 nu + 1: inputs at both ends of the step, their slopes a step at both ends, 1.
    inputs, slopes, measured: a row a sample; is_run_start: 1 where row `first_row` is the first of a run. z and root
    are those of the row before. variance (ny,) to counts and effects to latest: see `update_sample`; moved (nx, m k):
    room for effects; floor_root, forgetting_factor: see `forget`, which is done every `forget_every` samples,
    samples_since counting them.
    """
    k, nx, nu = expansion_point.size, x.size, inputs.shape[1]
    ny = variance.size
    for row in range(first_row, measured.shape[0]):
        if row > first_row or is_run_start == 0:
            for j in range(nu):
                w[j], w[nu + j] = inputs[row - 1, j], inputs[row, j]
                w[2 * nu + j], w[3 * nu + j] = slopes[row - 1, j], slopes[row, j]
            w[4 * nu] = 1.0
            size = 0.0
            for i in range(nx):
                total = 0.0
                for c in range(k):
                    step[i, c] = 0.0
                for m in range(nx):
                    a = z[k + m]
                    step[i, k + m] = step_matrix[i, m]
                    total += step_matrix[i, m] * a
                    for c in range(k):
                        step[i, c] += a * de[i, m, c]
                for m in range(w.size):
                    a = w[m]
                    if a != 0.0:
                        total += step_matrix[i, nx + m] * a
                        for c in range(k):
                            step[i, c] += a * dg[i, m, c]
                for c in range(k):
                    total += step[i, c] * (z[c] - expansion_point[c])
                x[i] = total
                size += abs(total)
            for i in range(nx):
                z[k + i] = x[i]
            _propagate(root, step, k, work)
            _propagate(effects, step, k, moved)
            if not size < DIVERGED:
                return row
        for i in range(ny):
            total = 0.0
            for c in range(k):
                h[i, c] = 0.0
            for m in range(nx):
                a = z[k + m]
                h[i, k + m] = output_matrix[i, m]
                total += output_matrix[i, m] * a
                for c in range(k):
                    h[i, c] += a * dc[i, m, c]
            for m in range(nu + 1):
                a = inputs[row, m] if m < nu else 1.0
                if a != 0.0:
                    total += output_matrix[i, nx + m] * a
                    for c in range(k):
                        h[i, c] += a * dd[i, m, c]
            for c in range(k):
                total += h[i, c] * (z[c] - expansion_point[c])
            predicted[i] = total
        for j in range(z.size):
            z_reference[j] = z[j]
        update_sample(root, z, z_reference, h, predicted, measured[row], variance, limit, memory, running_means, counts,
                      v, effects, information, score, innovation_effects, latest)  # fmt: skip
        _forget_when_due(root, z, floor_root, forgetting_factor, forget_every, samples_since, v)
    return -1


@kernel(
    I8(
        *(TANGENT, TANGENT, F8, I8, VECTOR, INDEX, INDEX),
        *(*_GAUSSIAN_STATE, *_SAMPLES, *_NOISE, *_FORGETTING, *_JUMPS, *_SCRATCH),
        *(TABLE, TABLE, TABLE, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX, VECTOR),
    ),
    **LEAN,
)
def filter_runge_kutta(
    f, g, dt, substeps, p, coefficient_index, select, z, root, inputs, measured, first_row,
    is_run_start, variance, limit, memory, running_means, counts, floor_root, forgetting_factor, forget_every,
    samples_since, effects, information, score, innovation_effects, latest, moved, v, z_reference, predicted, h, step,
    work, chain, direct, link_u, w, s, work_x, work_u, work_w, jac, entries, g_jac, g_value,
):  # fmt: skip
    """Process rows of any model by Runge-Kutta steps, inputs running straight between samples, as `sensitivity` has it.

    coefficient_index: of the coefficients in p, whose other values stay. No model depends on time itself: it counts as
    0. select: outputs, states first, then those of g; chain .. s, entries: as of `rk4_tangent_step`, columns
    [coefficients | state].
    """
    k, nx, nu = coefficient_index.size, jac.shape[0], inputs.shape[1]
    ny = select.size
    x, rate, y, acc = work_x[0], work_x[1], work_x[2], work_x[3]
    u0, um, ub, u1 = work_u[0], work_u[1], work_u[2], work_u[3]
    w0, wm, w1 = work_w[0], work_w[1], work_w[2]
    length = dt / substeps
    for row in range(first_row, measured.shape[0]):
        for c in range(k):
            p[coefficient_index[c]] = z[c]
        for i in range(nx):
            x[i] = z[k + i]
        if row > first_row or is_run_start == 0:
            for i in range(nx):
                for c in range(s.shape[1]):
                    s[i, c] = 1.0 if c == k + i else 0.0
            for j in range(nu):
                u0[j], u1[j] = inputs[row - 1, j], inputs[row, j]
            size = 0.0
            for m in range(substeps):
                for j in range(nu):
                    half = 0.5 * (u1[j] - u0[j]) / (substeps - m)
                    um[j] = u0[j] + half
                    ub[j] = um[j] + half
                size += rk4_tangent_step(f, chain, direct, link_u, 0.0, x, w, s.shape[1] // LANES, u0, um, ub,
                                         w0, wm, w1, p, length, jac, entries, rate, y, acc)  # fmt: skip
                for j in range(nu):
                    u0[j] = ub[j]
            for i in range(nx):
                z[k + i] = x[i]
                for c in range(k + nx):
                    step[i, c] = s[i, c]
            _propagate(root, step, k, work)
            _propagate(effects, step, k, moved)
            if not size < DIVERGED:
                return row
        if g_value.size > 0:
            g(0.0, x, inputs[row], p, g_value, g_jac)
        for i in range(ny):
            here = select[i] - nx
            for j in range(k + nx):
                h[i, j] = 0.0
            if here < 0:
                predicted[i] = x[select[i]]
                h[i, k + select[i]] = 1.0
            else:
                predicted[i] = g_value[here]
                for c in range(k):
                    h[i, c] = g_jac[here, nx + nu + coefficient_index[c]]
                for j in range(nx):
                    h[i, k + j] = g_jac[here, j]
        for j in range(z.size):
            z_reference[j] = z[j]
        update_sample(root, z, z_reference, h, predicted, measured[row], variance, limit, memory, running_means, counts,
                      v, effects, information, score, innovation_effects, latest)  # fmt: skip
        _forget_when_due(root, z, floor_root, forgetting_factor, forget_every, samples_since, v)
    return -1


# Evidence for a jump, whose size has a Gaussian prior.


@kernel(void(CUBE, MATRIX, F8, VECTOR), **OPTIONS)
def jump_evidence(information, score, prior_variance, evidence):
    """Set the evidence for a jump, nats, at each of m instants: a mixture over its size (Willsky & Jones 1976).

    The jump is of all k coefficients together or of one alone, equally likely, each with this prior variance P:
    1/2 d' (J + I/P)^-1 d - 1/2 log |I + P J| for information J (k, k) and score d (k,). Nothing, minus infinity, where
    rounding leaves J + I/P without a root.
    """
    instants, k = score.shape
    root, solved = np.empty((k, k)), np.empty(k)
    for m in range(instants):
        of_all, highest, total = 0.0, -math.inf, 0.0
        for a in range(k):
            growth = 1.0 + prior_variance * max(information[m, a, a], 0.0)
            alone = 0.5 * prior_variance * score[m, a] ** 2 / growth - 0.5 * math.log(growth)
            if alone > highest:
                total = total * math.exp(highest - alone) + 1.0
                highest = alone
            else:
                total += math.exp(alone - highest)
            solved[a] = score[m, a]
            for b in range(a + 1):  # Cholesky by rows, and its solution
                pivot = information[m, a, b] + (1.0 / prior_variance if a == b else 0.0)
                for c in range(b):
                    pivot -= root[a, c] * root[b, c]
                root[a, b] = pivot / root[b, b] if b < a else math.sqrt(pivot) if pivot > 0.0 else math.nan
                if b < a:
                    solved[a] -= root[a, b] * solved[b]
            solved[a] /= root[a, a]
            of_all += 0.5 * solved[a] ** 2 - math.log(root[a, a]) - 0.5 * math.log(prior_variance)
        mean_of_each = highest + math.log(total / k)
        higher, lower = max(of_all, mean_of_each), min(of_all, mean_of_each)
        mixture = higher + math.log(0.5 + 0.5 * math.exp(lower - higher))
        evidence[m] = -math.inf if math.isnan(mixture) or math.isnan(of_all) else mixture
