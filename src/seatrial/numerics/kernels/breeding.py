"""One generation of a binary-coded genetic algorithm: roulette, elite, crossover at one point, mutation, decoding.

Codes are rows of 0 and 1, highest bit of each unknown first. Random numbers come from the caller, so that the draws
are those of one generator, whatever is compiled.
"""

import numpy as np
from numba import njit, types, void

from seatrial.numerics.kernels.kernel import I8, INDEX, MATRIX, OPTIONS, VECTOR, kernel

CODES = types.Array(types.uint8, 2, "C")


@kernel(void(VECTOR, VECTOR), **OPTIONS)
def selection_shares(fitness, share):
    """Fill share (n,) with (f - f_min) / sum (f - f_min), even where all are alike."""
    count = fitness.size
    least, largest = np.inf, -np.inf
    for i in range(count):
        least, largest = min(least, fitness[i]), max(largest, fitness[i])
    width = largest - least
    total = 0.0
    for i in range(count):
        share[i] = (fitness[i] - least) / width if width > 0.0 else 1.0
        total += share[i]
    for i in range(count):
        share[i] /= total


@kernel(void(VECTOR, MATRIX, types.Array(I8, 2, "C")), **OPTIONS)
def spin(share, uniforms, rows):
    """Fill rows, of the shape of `uniforms` in [0, 1), with those on which they fall; a share of zero never."""
    edge = np.cumsum(share)
    last = share.size - 1
    while last > 0 and not share[last] > 0.0:
        last -= 1
    for i in range(uniforms.shape[0]):
        for j in range(uniforms.shape[1]):
            rows[i, j] = min(np.searchsorted(edge, uniforms[i, j] * edge[-1], side="right"), last)


@kernel(void(CODES, CODES, INDEX, CODES), **OPTIONS)
def exchange_tails(mothers, fathers, cut, children):
    """Fill children (2 pairs, length): first with the mothers' heads, then with the fathers', the rest exchanged."""
    pairs, length = mothers.shape
    for k in range(pairs):
        for j in range(length):
            from_mother, from_father = mothers[k, j], fathers[k, j]
            children[k, j] = from_mother if j < cut[k] else from_father
            children[pairs + k, j] = from_father if j < cut[k] else from_mother


@njit(inline="always", **OPTIONS)
def _copy(source, target):
    for j in range(source.size):
        target[j] = source[j]


@kernel(void(CODES, VECTOR, INDEX, MATRIX, INDEX, MATRIX, types.float64, CODES), **OPTIONS)
def breed(codes, J, elite, spins, cut, flips, Pm, offspring):
    """Fill offspring (n, length): the elite's rows as they are, then children of parents drawn by roulette on 1 / J.

    J: (n,), infinite where a point cannot be; elite: rows kept (e,); spins: (2, pairs) and flips: (n - e, length),
    uniform in [0, 1); cut: (pairs,), first bit exchanged, the length for none; Pm: probability that a bit flips.
    """
    count, length = codes.shape
    pairs, kept = cut.size, elite.size
    fitness, share = np.empty(count), np.empty(count)
    for i in range(count):
        fitness[i] = 1.0 / max(J[i], np.finfo(np.float64).tiny)
    selection_shares(fitness, share)
    rows = np.empty((2, pairs), dtype=np.int64)
    spin(share, spins, rows)
    parents = np.empty((2, pairs, length), dtype=np.uint8)
    for side in range(2):
        for k in range(pairs):
            _copy(codes[rows[side, k]], parents[side, k])
    children = np.empty((2 * pairs, length), dtype=np.uint8)
    exchange_tails(parents[0], parents[1], cut, children)
    for i in range(kept):
        _copy(codes[elite[i]], offspring[i])
    for i in range(count - kept):
        for j in range(length):
            offspring[kept + i, j] = children[i, j] ^ (flips[i, j] < Pm)


@kernel(void(CODES, MATRIX), **OPTIONS)
def decode_codes(codes, unit):
    """Fill unit (n, d) with the places of the codes (n, d bits) in the unit box: all zeros 0, all ones 1."""
    d = unit.shape[1]
    bits = codes.shape[1] // d
    most = 2.0**bits - 1.0
    for m in range(codes.shape[0]):
        for i in range(d):
            value = 0.0
            for j in range(i * bits, (i + 1) * bits):
                value = 2.0 * value + codes[m, j]
            unit[m, i] = value / most
