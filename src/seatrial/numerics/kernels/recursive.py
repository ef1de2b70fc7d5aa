"""Coefficients and state of a run without process noise, estimated as samples come, as square roots."""

import math

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
    gain (Willsky & Jones 1976, IEEE Trans. AC 21, 108). weight: 0 where it says nothing of a jump. effects (n, k m),
    instants fastest, as everywhere; information (k, k, m), lower triangle; score (k, m), innovation_effects (k m,).
    """
    k, instants = score.shape
    for c in range(innovation_effects.size):
        innovation_effects[c] = 0.0
    for i in range(h.size):
        if h[i] != 0.0:
            for c in range(innovation_effects.size):
                innovation_effects[c] += h[i] * effects[i, c]
    share = weight / total
    for a in range(k):
        for b in range(a + 1):
            for m in range(instants):
                information[a, b, m] += (
                    share * innovation_effects[a * instants + m] * innovation_effects[b * instants + m]
                )
        for m in range(instants):
            score[a, m] += share * e * innovation_effects[a * instants + m]
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


# Evidence for a jump, whose size has a Gaussian prior.


@njit(inline="always", **OPTIONS)
def _solve_jumps(information, score, prior_variance, root, solved):
    """Set root (k, k, m) of J + I/P, lower, at each instant, and solved (k, m), root^-1 d; NaN where there is none."""
    k, instants = score.shape
    for a in range(k):
        for m in range(instants):
            solved[a, m] = score[a, m]
        for b in range(a + 1):  # Cholesky by rows
            own = 1.0 / prior_variance if a == b else 0.0
            for m in range(instants):
                root[a, b, m] = information[a, b, m] + own
            for c in range(b):
                for m in range(instants):
                    root[a, b, m] -= root[a, c, m] * root[b, c, m]
            if b < a:
                for m in range(instants):
                    root[a, b, m] /= root[b, b, m]
                    solved[a, m] -= root[a, b, m] * solved[b, m]
        for m in range(instants):
            root[a, a, m] = math.sqrt(root[a, a, m])
            solved[a, m] /= root[a, a, m]


@njit(inline="always", **OPTIONS)
def _mixture_evidence(information, score, prior_variance, root, solved, m):
    """Return the evidence at instant m from what `_solve_jumps` made."""
    k = score.shape[0]
    of_all, highest, total = 0.0, -math.inf, 0.0
    for a in range(k):
        growth = 1.0 + prior_variance * max(information[a, a, m], 0.0)
        alone = 0.5 * prior_variance * score[a, m] ** 2 / growth - 0.5 * math.log(growth)
        if alone > highest:
            total = total * math.exp(highest - alone) + 1.0
            highest = alone
        else:
            total += math.exp(alone - highest)
        of_all += 0.5 * solved[a, m] ** 2 - math.log(root[a, a, m]) - 0.5 * math.log(prior_variance)
    mean_of_each = highest + math.log(total / k)
    higher, lower = max(of_all, mean_of_each), min(of_all, mean_of_each)
    mixture = higher + math.log(0.5 + 0.5 * math.exp(lower - higher))
    return -math.inf if math.isnan(mixture) or math.isnan(of_all) else mixture


@kernel(void(CUBE, MATRIX, F8, CUBE, MATRIX, VECTOR), **LEAN)
def jump_evidence(information, score, prior_variance, root, solved, evidence):
    """Set the evidence for a jump, nats, at each of m instants: a mixture over its size (Willsky & Jones 1976).

    The jump is of all k coefficients together or of one alone, equally likely, each with this prior variance P:
    1/2 d' (J + I/P)^-1 d - 1/2 log |I + P J| for information J (k, k, m), of which the lower triangle counts, and
    score d (k, m). Nothing, minus infinity, where rounding leaves J + I/P without a root. root (k, k, m), solved
    (k, m): room.
    """
    _solve_jumps(information, score, prior_variance, root, solved)
    for m in range(score.shape[1]):
        evidence[m] = _mixture_evidence(information, score, prior_variance, root, solved, m)


@njit(inline="always", **OPTIONS)
def _is_jump_likely(information, score, prior_variance, threshold, root, solved):
    """Whether the evidence at any instant is above a threshold; it is below the larger of its quadratic forms."""
    _solve_jumps(information, score, prior_variance, root, solved)
    k, instants = score.shape
    for m in range(instants):
        of_all, of_one = 0.0, 0.0
        for a in range(k):
            of_all += 0.5 * solved[a, m] ** 2
            growth = 1.0 + prior_variance * max(information[a, a, m], 0.0)
            of_one = max(of_one, 0.5 * prior_variance * score[a, m] ** 2 / growth)
        is_near = max(of_all, of_one) > threshold
        if is_near and _mixture_evidence(information, score, prior_variance, root, solved, m) > threshold:
            return True
    return False


# A bank of instants, at each of which a jump of the coefficients is looked for.

CLOSE_SAMPLES = 8
"""Up to whose age every instant is kept; of twice the age every second, and so on (chosen)."""

LOOKS, STATE = 0, 1
"""Where `progress` holds how many samples were looked at, and what became of the watch: nothing, or one of these."""
CHANGED, UNSOUND = 1, 2


@njit(inline="always", **OPTIONS)
def _close_instant(effects, information, score, m):
    k, instants = score.shape
    for a in range(k):
        score[a, m] = 0.0
        for b in range(a + 1):
            information[a, b, m] = 0.0
        for i in range(effects.shape[0]):
            effects[i, a * instants + m] = 0.0


@njit(inline="always", **OPTIONS)
def _drop_old_instants(effects, information, score, opened, look):
    """Drop the instants that are too close to others at their age, and return a vacant place."""
    vacant, doublings = -1, (opened.size - CLOSE_SAMPLES) * 2 // CLOSE_SAMPLES
    for m in range(opened.size):
        if opened[m] >= 0:
            age = look - opened[m]
            for doubling in range(doublings + 1):
                is_single = doubling == doublings or opened[m] % (2 << doubling) != 0
                if age == CLOSE_SAMPLES << doubling and is_single:
                    _close_instant(effects, information, score, m)
                    opened[m] = -1
        if opened[m] < 0:
            vacant = m
    return vacant


@njit(inline="always", **OPTIONS)
def _watch_sample(
    root, z, running_means, counts, memory, effects, information, score, room, solved, opened, estimates, bounds,
    limits, progress,
):  # fmt: skip
    """Look for a jump at any instant of the bank, and keep the present one; True where the watch ends.

    opened (m,): look at which an instant was kept, -1 where there is none; estimates (2 k, m): value and standard error
    of the coefficients there. bounds (2, k): of the coefficients. limits: variance of a jump, threshold, relative
    standard error up to which coefficients count as known, mean squared innovation beyond which the filter is unsound.
    """
    k, instants = score.shape
    is_sound = True
    for a in range(k):
        is_sound = is_sound and bounds[0, a] <= z[a] <= bounds[1, a]
    for channel in range(running_means.shape[0]):
        is_filled = counts[USED, channel] >= 0.5 * memory
        is_sound = is_sound and not (is_filled and running_means[channel, 0] > limits[3])
    if not is_sound:
        progress[STATE] = UNSOUND
    elif _is_jump_likely(information, score, limits[0], limits[1], room, solved):
        progress[STATE] = CHANGED
    if progress[STATE] != 0:
        return True
    look = progress[LOOKS]
    progress[LOOKS] = look + 1
    place, is_known = _drop_old_instants(effects, information, score, opened, look), True
    for a in range(k):
        variance = 0.0
        for j in range(z.size):
            variance += root[a, j] * root[a, j]
        estimates[a, place], estimates[k + a, place] = z[a], math.sqrt(variance)
        is_known = is_known and estimates[k + a, place] <= limits[2] * abs(z[a])
    if is_known:
        opened[place] = look
        for a in range(k):
            effects[a, a * instants + place] = z[a] if z[a] != 0.0 else 1.0
    return False


# Coefficients and state of a run without process noise, estimated as the samples come.

_GAUSSIAN_STATE = (VECTOR, MATRIX)
_SAMPLES = (MATRIX, MATRIX, I8, I8)
_NOISE = (VECTOR, F8, F8, MATRIX, TABLE)
_FORGETTING = (MATRIX, F8, I8, INDEX)
_JUMPS = (MATRIX, CUBE, MATRIX, VECTOR, MATRIX, MATRIX, CUBE, MATRIX, INDEX, MATRIX, MATRIX, VECTOR, INDEX)
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
    samples_since, effects, information, score, innovation_effects, latest, moved, jump_root, solved,
    opened, estimates, bounds, limits, progress, v, z_reference, predicted, h, step,
    work, w, x,
):  # fmt: skip
    """Process rows first_row.. of an affine model; return the row at which the state left all bounds, or -1.

    step_matrix (nx, nx + nw), output_matrix (ny, nx + nu + 1): the step and the outputs at `expansion_point`, columns
    state, then inputs; their derivatives by the coefficients, last axis: de (nx, nx, k), dg (nx, nw, k), dc (ny, nx,
    k), dd (ny, nu + 1, k). nw = 4 nu + 1: inputs at both ends of the step, their slopes a step at both ends, 1.
    inputs, slopes (2 nu: those of the row before, its own), measured: a row a sample; is_run_start: 1 where row
    `first_row` is the first of a run. z and root are those of the row before. variance (ny,) to counts and effects to
    progress: see `update_sample`, `_watch_sample`; moved (nx, k m): room for effects; floor_root, forgetting_factor:
    see `forget`, which is done every `forget_every` samples, samples_since counting them. Where the watch ends its row
    is returned, too.
    """
    k, nx, nu = expansion_point.size, x.size, inputs.shape[1]
    ny = variance.size
    for row in range(first_row, measured.shape[0]):
        if row > first_row or is_run_start == 0:
            for j in range(nu):
                w[j], w[nu + j] = inputs[row - 1, j], inputs[row, j]
                w[2 * nu + j], w[3 * nu + j] = slopes[row, j], slopes[row, nu + j]
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
        if opened.size > 0 and _watch_sample(
            root, z, running_means, counts, memory, effects, information, score, jump_root, solved, opened, estimates,
            bounds, limits, progress,
        ):  # fmt: skip
            return row
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
    samples_since, effects, information, score, innovation_effects, latest, moved, jump_root, solved,
    opened, estimates, bounds, limits, progress, v, z_reference, predicted, h, step,
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
        if opened.size > 0 and _watch_sample(
            root, z, running_means, counts, memory, effects, information, score, jump_root, solved, opened, estimates,
            bounds, limits, progress,
        ):  # fmt: skip
            return row
    return -1
