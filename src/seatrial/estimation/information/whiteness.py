"""What residuals look like: autocorrelation, tests of whiteness, errors of two candidates on the same parts."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from scipy.special import chdtrc, stdtrit

from seatrial.core.values import Array

# What residuals look like: autocorrelation, correlation time, whiteness.


def autocorrelation(residuals: Sequence[Array], lags: int) -> Array:
    """Autocorrelation at lags 0..lags, averaged over the series; NaN samples count as zero. Shape (lags + 1,).

    Box, Jenkins & Reinsel 2008, eq. (2.1.12), with the mean left in: a residual's mean is part of its colour.
    """
    total = np.zeros(lags + 1)
    for length, alike in groupby(residuals, len):  # one call for all series of one length
        pieces = np.stack(list(alike))
        size = 2 ** int(np.ceil(np.log2(length + lags + 1)))
        spectra = np.fft.rfft(np.where(np.isfinite(pieces), pieces, 0.0), size)
        products = np.fft.irfft(np.abs(spectra) ** 2, size)
        kept = min(lags, length - 1) + 1
        total[:kept] = np.sum(np.concatenate([total[None, :kept], products[:, :kept]]), axis=0)
    return total / total[0] if total[0] > 0 else np.eye(1, lags + 1)[0]


def variance_inflation(rho: Array) -> float:
    """Factor by which the variance of a mean exceeds that of white noise, 1 + 2 sum(rho) (Sokal 1997, eq. (2.16)).

    The sum stops at the first lag at which rho falls to zero (initial positive sequence; Geyer 1992).
    """
    negative = np.flatnonzero(rho[1:] <= 0)
    stop = int(negative[0]) + 1 if len(negative) else len(rho)
    return float(1.0 + 2.0 * np.sum(rho[1:stop]))


def whiteness_p(rho: Array, samples: int, lags: int = 20) -> float:  # first samples of correlation; chosen, as usual
    """p-value that residuals with this autocorrelation are white (Ljung & Box 1978)."""
    count = min(lags, len(rho) - 1, samples - 1)
    if count < 1:
        return 1.0
    k = np.arange(1, count + 1)
    statistic = samples * (samples + 2) * float(np.sum(rho[1 : count + 1] ** 2 / (samples - k)))
    return float(chdtrc(count, statistic))


# Are residuals white? Portmanteau tests of each channel, short and long, as one verdict.

WHITENESS_LAGS = (20, 100)
"""Lags of the two tests: correlation over a few samples, and weak correlation over many; chosen."""

FALSE_ALARMS = 0.01
"""Probability with which white residuals fail in any channel by either test (Bonferroni); chosen."""


@dataclass(frozen=True, eq=False)
class WhitenessTest:
    """Tests of Ljung & Box (1978, Biometrika 65, 297) with 20 and 100 lags on each channel.

    Attributes:
        p_values: of each channel, twice the smaller of its two tests' p-values, at most 1, (ny,).
    """

    p_values: Array

    @property
    def level(self) -> float:
        """The p-value below which a channel is not white."""
        return FALSE_ALARMS / max(len(self.p_values), 1)

    @property
    def is_white(self) -> bool:
        """Whether no channel fails."""
        return bool(np.all(self.p_values >= self.level))

    @property
    def smallest(self) -> float:
        """Smallest p-value over the channels, times their number, at most 1: below 0.01 they are not white."""
        return float(min(1.0, len(self.p_values) * np.min(self.p_values, initial=1.0)))


def whiteness_test(pieces: Sequence[Array]) -> WhitenessTest:
    """Test residuals of runs, each (rows, ny); NaN where nothing was measured, which counts as no sample."""
    ny = pieces[0].shape[1]
    longest = max(len(p) for p in pieces)
    p_values = np.ones(ny)
    for channel in range(ny):
        columns = [p[:, channel] for p in pieces]
        rho = autocorrelation(columns, min(max(WHITENESS_LAGS), longest // 2))
        samples = int(sum(np.isfinite(c).sum() for c in columns))
        tests = [whiteness_p(rho, samples, lags) for lags in WHITENESS_LAGS]
        p_values[channel] = min(1.0, len(tests) * min(tests))
    return WhitenessTest(p_values)


# Errors of two candidates on the same parts of records: is one worse by more than the parts' scatter explains?

_LEVEL = 0.95  # of the one-sided test; chosen


def standard_error(excess: Array) -> float:
    """Return that of the mean excess of one candidate's errors over another's, (parts,); infinite of one part."""
    return float(np.std(excess, ddof=1) / np.sqrt(len(excess))) if len(excess) > 1 else np.inf


def is_no_worse(excess: Array, negligible: float) -> bool:
    """Return whether the mean excess, of (parts,), is negligible or within its scatter (paired t test, 95 %)."""
    if not np.all(np.isfinite(excess)):
        return False
    level = float(stdtrit(max(len(excess) - 1, 1), _LEVEL))
    return bool(excess.mean() <= max(level * standard_error(excess), negligible))
