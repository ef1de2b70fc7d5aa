"""Heat map of the correlations between the free coefficients' errors."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.matrix import cells
from seatrial.core.figures.plot import drawing
from seatrial.core.values import Array
from seatrial.core.values.arrays import correlation_matrix


def heat_map(names: Sequence[str], covariance: Array) -> str:
    """Lower triangle, numbers in the cells where they fit; empty for fewer than two coefficients."""
    n = len(names)
    if n < 2 or covariance.shape != (n, n):
        return ""
    below = correlation_matrix(covariance)[1:, :-1]
    parts, right, bottom = cells(names[1:], names[:-1], below, is_drawn=np.tri(n - 1, dtype=bool))
    return drawing(parts, bottom, "correlations of the free coefficients", right + 4)
