"""Do residuals of a fit hint at a disturbance? A test of their spectrum that costs next to nothing.

A disturbance passes through the ship, so that its trace lies at low frequencies: white sensor noise is compared with
the same plus first-order noise by Whittle's likelihood (Whittle 1953, Ark. Mat. 2, 423). Where nothing is gained here
no filter is run; where something is, the likelihood of the filter decides.
"""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import Array

HINT = 6.0
"""Twice the gain of log-likelihood in any channel from which on disturbances are fitted: 1 % by chance; chosen."""

# longest piece whose periodogram is taken, and shortest that counts, samples; chosen
_LONGEST_PIECE, _SHORTEST_PIECE = 4096, 32
# correlation times that are tried, samples, and how many; chosen
_SHORTEST, _LONGEST, _TIME_COUNT = 2.0, 2000.0, 10
# powers at zero frequency over that of white noise that are tried, and how many besides none; chosen
_FAINTEST, _STRONGEST, _POWER_COUNT = 1e-2, 1e6, 25
_TIMES = np.geomspace(_SHORTEST, _LONGEST, _TIME_COUNT)
_POWERS = np.concatenate([[0.0], np.geomspace(_FAINTEST, _STRONGEST, _POWER_COUNT)])


def spectral_hint(pieces: Sequence[Array]) -> float:
    """Return twice the gain of log-likelihood by first-order noise in the channel where it is largest.

    pieces: residuals of each run, (rows, ny); NaN where nothing was measured, which counts as zero.
    """
    length = min(_LONGEST_PIECE, min(len(p) for p in pieces))
    if length < _SHORTEST_PIECE:
        return 0.0
    cut = [p[a : a + length] for p in pieces for a in range(0, len(p) - length + 1, length)]
    power = np.mean([np.abs(np.fft.rfft(np.nan_to_num(c), axis=0)) ** 2 for c in cut], axis=0)[1:]
    angle = 2.0 * np.pi * np.arange(1, len(power) + 1) / length
    return max((len(cut) * _gain(power[:, i], angle) for i in range(power.shape[1])), default=0.0)


def _gain(power: Array, angle: Array) -> float:
    """Twice the gain for one averaged periodogram (frequencies,); the level of the noise is profiled out."""
    if not np.all(power > 0.0):
        return 0.0
    low_pass = 1.0 / (1.0 + (angle * _TIMES[:, None]) ** 2)
    shape = 1.0 + _POWERS[:, None, None] * low_pass
    loss = np.mean(np.log(shape), axis=2) + np.log(np.mean(power / shape, axis=2))
    return float(2.0 * len(power) * (loss[0, 0] - loss.min()))
