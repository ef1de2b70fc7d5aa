"""Are residuals white? Portmanteau tests of each channel, short and long, as one verdict."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.information.autocorrelation import autocorrelation, whiteness_p

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
