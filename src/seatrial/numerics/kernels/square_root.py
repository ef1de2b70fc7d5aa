"""A Gaussian estimate kept as a square root: covariance P = R R', R square, not triangular.

Measurements come one scalar after the other (Potter; Bierman 1977, section II.6; Kaminski, Bryson & Schmidt 1971,
eq. (10)): P stays symmetric and positive however nearly singular it is, and nothing is divided by what may vanish.
Without process noise a prediction is R <- F R, so that R is never made triangular again.
"""

import math

from numba import njit

from seatrial.numerics.kernels.types import OPTIONS

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
def update_sample(
    root, z, z_reference, h, predicted, measured, variance, huber_limit, memory, running_means, counts, v
):
    """Update by all channels of one sample, NaN being no measurement.

    h (ny, n), predicted (ny,): slopes and values at z_reference. An innovation beyond `huber_limit` standard deviations
    counts linearly (Huber 1964): its variance is raised as far as its weight falls, and what moves z ends at the limit.
    running_means (ny, 2): over the latest `memory` of the squared innovation, by its variance and plain, cut at the
    limit; counts (2, ny).
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
        r /= cut
        most = huber_limit * math.sqrt(spread + r)
        update_scalar(root, z, v, spread, r, min(max(e, -most), most))


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
