"""Heat map of the correlations between the free coefficients' errors."""

from collections.abc import Sequence

import numpy as np

from seatrial.report.figures.matrix import cells
from seatrial.report.figures.plot import drawing
from seatrial.values import Array


def correlation_of(covariance: Array) -> Array:
    """Covariance (n, n) scaled to a unit diagonal; rows without a variance are NaN."""
    spread = np.sqrt(np.where(np.diag(covariance) > 0, np.diag(covariance), np.nan))
    return covariance / np.outer(spread, spread)


def heat_map(names: Sequence[str], covariance: Array) -> str:
    """Lower triangle, numbers in the cells where they fit; empty for fewer than two coefficients."""
    n = len(names)
    if n < 2 or covariance.shape != (n, n):
        return ""
    below = correlation_of(covariance)[1:, :-1]
    parts, right, bottom = cells(names[1:], names[:-1], below, is_drawn=np.tri(n - 1, dtype=bool))
    return drawing(parts, bottom, "correlations of the free coefficients", right + 4)
