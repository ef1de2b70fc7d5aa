"""Fewer points of a curve than were measured, without a visible difference."""

from itertools import pairwise

import numpy as np

from seatrial.core.figures.marks import Array

# points of a curve: more than a panel of a page has pixels for extremes
POINTS = 400


def decimated(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """Return a curve of at most about `points` points that keeps the extremes of every stretch; NaN stays NaN."""
    if len(x) <= points:
        return x, y
    edges = np.linspace(0, len(x), points // 2 + 1).astype(int)
    low, high = np.where(np.isnan(y), np.inf, y), np.where(np.isnan(y), -np.inf, y)
    kept: list[int] = []
    for first, last in pairwise(edges):
        kept += sorted({first + int(np.argmin(low[first:last])), first + int(np.argmax(high[first:last]))})
    return x[kept], y[kept]


def thinned(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """Return evenly chosen points of a curve, its ends among them."""
    kept = np.unique(np.linspace(0, len(x) - 1, min(points, len(x))).astype(int))
    return x[kept], y[kept]
