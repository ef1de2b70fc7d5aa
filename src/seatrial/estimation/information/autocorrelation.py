"""What residuals look like: autocorrelation, correlation time, whiteness."""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc

from seatrial.core.values import Array


def autocorrelation(residuals: Sequence[Array], lags: int) -> Array:
    """Autocorrelation at lags 0..lags, averaged over the series; NaN samples count as zero. Shape (lags + 1,).

    Box, Jenkins & Reinsel 2008, eq. (2.1.12), with the mean left in: a residual's mean is part of its colour.
    """
    total = np.zeros(lags + 1)
    for piece in residuals:
        e = np.where(np.isfinite(piece), piece, 0.0)
        size = 2 ** int(np.ceil(np.log2(len(e) + lags + 1)))
        spectrum = np.fft.rfft(e, size)
        product = np.fft.irfft(np.abs(spectrum) ** 2, size)[: lags + 1]
        total[: min(lags, len(e) - 1) + 1] += product[: min(lags, len(e) - 1) + 1]
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
