"""Feedback loops linear in their gains, by the thousand: Routh's test, the peak of the sensitivity, variances.

L(j omega_f) = sum_i k_i (re[i, f] + j im[i, f]). Loops over frequencies stand innermost, so that they become vectors.
"""

import numpy as np
from numba import void

from seatrial.numerics.kernels.kernel import F8, I8, INDEX, MATRIX, OPTIONS, VECTOR, kernel

# sums over frequencies may be taken in any order: four or eight at once
_ANY_ORDER_SUMS = {**OPTIONS, "fastmath": {"contract", "reassoc", "nsz", "arcp"}}


@kernel(I8(VECTOR, I8), **OPTIONS)
def is_hurwitz(row, n):
    """Return 1 where the polynomial row[:n + 1], highest power first, has all roots left of the axis (Routh 1877).

    Destroys `row`, which has n + 1 places or more. The array is folded: row r of the scheme stands on alternate places.
    """
    if row[0] == 0.0:
        return 0
    sign = 1.0 if row[0] > 0.0 else -1.0
    for first in range(n):
        pivot = row[first + 1]
        if not pivot * sign > 0.0:
            return 0
        factor = row[first] / pivot
        for j in range(first + 2, n, 2):
            row[j] -= factor * row[j + 1]
    return 1


@kernel(void(VECTOR, MATRIX, MATRIX, VECTOR, VECTOR), **_ANY_ORDER_SUMS)
def _return_difference(k, re, im, x, y):
    """Set x + j y = 1 + L at each frequency."""
    for f in range(x.size):
        x[f] = 1.0 + k[0] * re[0, f]
        y[f] = k[0] * im[0, f]
    for i in range(1, k.size):
        for f in range(x.size):
            x[f] += k[i] * re[i, f]
            y[f] += k[i] * im[i, f]


@kernel(F8(VECTOR, VECTOR, I8), **_ANY_ORDER_SUMS)
def _nearest_to_zero(x, y, place):
    """Return where in -1 to 1 about a sample the complex parabola through its neighbours comes nearest to zero."""
    bx, by = 0.5 * (x[place + 1] - x[place - 1]), 0.5 * (y[place + 1] - y[place - 1])
    cx = 0.5 * (x[place + 1] + x[place - 1]) - x[place]
    cy = 0.5 * (y[place + 1] + y[place - 1]) - y[place]
    u = 0.0
    for _ in range(4):
        zx, zy = x[place] + u * (bx + u * cx), y[place] + u * (by + u * cy)
        dx, dy = bx + 2.0 * u * cx, by + 2.0 * u * cy
        curved = dx * dx + dy * dy + 2.0 * (zx * cx + zy * cy)
        if not curved > 0.0:
            break
        u = min(max(u - (zx * dx + zy * dy) / curved, -1.0), 1.0)
    return u


@kernel(F8(VECTOR, I8, F8), **_ANY_ORDER_SUMS)
def _on_parabola(values, place, u):
    """Return the value at u in -1 to 1 of the parabola through a sample and its neighbours."""
    before, after = 0.5 * u * (u - 1.0), 0.5 * u * (u + 1.0)
    return before * values[place - 1] + (1.0 - u * u) * values[place] + after * values[place + 1]


@kernel(F8(VECTOR, VECTOR), **_ANY_ORDER_SUMS)
def _least_return_difference(x, y):
    """Return the least |1 + L| along the curve x + j y: a complex parabola through the nearest three samples."""
    count = x.size
    least = np.inf
    for f in range(count):
        least = min(least, x[f] * x[f] + y[f] * y[f])
    place = 0
    for f in range(count):
        if x[f] * x[f] + y[f] * y[f] <= least:
            place = f
    if place == 0 or place == count - 1:
        return np.sqrt(least)
    u = _nearest_to_zero(x, y, place)
    zx, zy = _on_parabola(x, place, u), _on_parabola(y, place, u)
    return np.sqrt(min(zx * zx + zy * zy, least))


@kernel(void(VECTOR, MATRIX, MATRIX, VECTOR, MATRIX), **_ANY_ORDER_SUMS)
def sensitivity_peaks(k, re, im, peaks, slopes):
    """Compute the largest peaks of |S|, largest first, and d |S| / d gains, by parabolas; zero where there are fewer.

    k: gains (g,). re, im: L_i (g, f) over the band. peaks (p,); slopes (p, g).
    """
    count = re.shape[1]
    x, y, size = np.empty(count), np.empty(count), np.empty(count)
    places, peak_count, smallest = np.empty(peaks.size, np.int64), 1, np.inf
    _return_difference(k, re, im, x, y)
    for f in range(count):
        size[f] = x[f] * x[f] + y[f] * y[f]
        if size[f] < smallest:
            smallest, places[0] = size[f], min(max(f, 1), count - 2)
    for f in range(1, count - 1):
        if f == places[0] or size[f] > size[f - 1] or size[f] > size[f + 1]:
            continue
        rank = peak_count
        while rank > 1 and size[f] < size[places[rank - 1]]:
            rank -= 1
        if rank < peaks.size:
            peak_count = min(peak_count + 1, peaks.size)
            for later in range(peak_count - 1, rank, -1):
                places[later] = places[later - 1]
            places[rank] = f
    peaks[:] = 0.0
    slopes[:] = 0.0
    for row in range(peak_count):
        place = places[row]
        u = _nearest_to_zero(x, y, place)
        zx, zy = _on_parabola(x, place, u), _on_parabola(y, place, u)
        least = np.sqrt(zx * zx + zy * zy)
        peaks[row] = 1.0 / least
        for i in range(k.size):
            toward = zx * _on_parabola(re[i], place, u) + zy * _on_parabola(im[i], place, u)
            slopes[row, i] = -toward / least**3


@kernel(F8(MATRIX, I8, VECTOR, VECTOR, VECTOR, VECTOR), **_ANY_ORDER_SUMS)
def _mixed_variance(weights, first, s, t, x, y):
    """Return the sum of w0 |S|^2 + w1 |T|^2 + 2 Re(S conj(T) (w2 + j w3)), T = L S, of four rows of weights."""
    total = 0.0
    for f in range(s.size):
        both = (x[f] - 1.0) * weights[first + 2, f] + y[f] * weights[first + 3, f]
        total += weights[first, f] * s[f] + weights[first + 1, f] * t[f] + 2.0 * s[f] * both
    return total


@kernel(
    void(MATRIX, VECTOR, MATRIX, INDEX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX),
    **_ANY_ORDER_SUMS,
)
def evaluate_loops(
    k, d, n, idle, re, im, s_weights, t_weights, mixed_weights, noise_weights, band_re, band_im, Ms, out
):
    """Compute sensitivity peak and variances of loops; infinite where a loop is unstable.

    k: gains (m, g). d (n + 1,), n (g, n + 1): characteristic polynomial d + k n, of which the last `idle` (m,)
    coefficients vanish and are left out. re, im: L_i (g, f) at the frequencies
    of the sea; s_weights (rs, f), t_weights (rt, f): what |S|^2 and |L S|^2 weigh there; mixed_weights (4 rm, f): four
    rows for each variance of both, as of `_mixed_variance`; noise_weights (rs, f): what |L S|^2 weighs in the first rs.
    band_re, band_im: L_i over the whole band, for the peak;
    without frequencies no peak. Ms (m,); out (m, rs + rt + rm).
    """
    row, x, y = np.empty(d.size), np.empty(re.shape[1]), np.empty(re.shape[1])
    s, t = np.empty(re.shape[1]), np.empty(re.shape[1])
    wide_x, wide_y = np.empty(band_re.shape[1]), np.empty(band_re.shape[1])
    for m in range(k.shape[0]):
        order = d.size - 1 - idle[m]
        for j in range(order + 1):
            total = d[j]
            for i in range(k.shape[1]):
                total += k[m, i] * n[i, j]
            row[j] = total
        if is_hurwitz(row, order) == 0:
            Ms[m] = np.inf
            for j in range(out.shape[1]):
                out[m, j] = np.inf
            continue
        if wide_x.size > 0:
            _return_difference(k[m], band_re, band_im, wide_x, wide_y)
            Ms[m] = max(1.0 / _least_return_difference(wide_x, wide_y), 1.0)
        _return_difference(k[m], re, im, x, y)
        for f in range(x.size):
            s[f] = 1.0 / (x[f] * x[f] + y[f] * y[f])
            t[f] = ((x[f] - 1.0) * (x[f] - 1.0) + y[f] * y[f]) * s[f]
        for j in range(s_weights.shape[0]):
            total = 0.0
            for f in range(x.size):
                total += s_weights[j, f] * s[f] + noise_weights[j, f] * t[f]
            out[m, j] = total
        for j in range(t_weights.shape[0]):
            total = 0.0
            for f in range(x.size):
                total += t_weights[j, f] * t[f]
            out[m, s_weights.shape[0] + j] = total
        both = s_weights.shape[0] + t_weights.shape[0]
        for j in range(mixed_weights.shape[0] // 4):
            out[m, both + j] = _mixed_variance(mixed_weights, 4 * j, s, t, x, y)


@kernel(void(VECTOR, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX), **_ANY_ORDER_SUMS)
def variance_gradients(k, re, im, s_weights, t_weights, mixed_weights, noise_weights, out):
    """Set out = d variance / d gain of one loop, (rs + rt + rm, g), of weights as of `evaluate_loops`.

    With z = 1 + L: d|S|^2 = -2 Re(conj(z) L_i) |S|^4, d|L S|^2 = 2 Re(conj(L) L_i) |S|^2 + |L|^2 d|S|^2,
    d(S conj(T)) = conj(L_i) |S|^2 + conj(L) d|S|^2.
    """
    count = re.shape[1]
    x, y = np.empty(count), np.empty(count)
    ds, dt = np.empty(count), np.empty(count)
    _return_difference(k, re, im, x, y)
    for i in range(k.size):
        for f in range(count):
            s = 1.0 / (x[f] * x[f] + y[f] * y[f])
            size = (x[f] - 1.0) * (x[f] - 1.0) + y[f] * y[f]
            ds[f] = -2.0 * (x[f] * re[i, f] + y[f] * im[i, f]) * s * s
            dt[f] = 2.0 * ((x[f] - 1.0) * re[i, f] + y[f] * im[i, f]) * s + size * ds[f]
        for j in range(s_weights.shape[0]):
            total = 0.0
            for f in range(count):
                total += s_weights[j, f] * ds[f] + noise_weights[j, f] * dt[f]
            out[j, i] = total
        for j in range(t_weights.shape[0]):
            total = 0.0
            for f in range(count):
                total += t_weights[j, f] * dt[f]
            out[s_weights.shape[0] + j, i] = total
        both = s_weights.shape[0] + t_weights.shape[0]
        for j in range(mixed_weights.shape[0] // 4):
            total = 0.0
            for f in range(count):
                s = 1.0 / (x[f] * x[f] + y[f] * y[f])
                real = re[i, f] * s + (x[f] - 1.0) * ds[f]
                imag = im[i, f] * s + y[f] * ds[f]
                total += mixed_weights[4 * j, f] * ds[f] + mixed_weights[4 * j + 1, f] * dt[f]
                total += 2.0 * (mixed_weights[4 * j + 2, f] * real + mixed_weights[4 * j + 3, f] * imag)
            out[both + j, i] = total
