"""Heat map of the correlations between the free coefficients' errors."""

from collections.abc import Sequence

import numpy as np

from seatrial.report.figures.canvas import WIDTH, canvas, styled, svg
from seatrial.values import Array

NUMBERED = 24


def correlation_of(covariance: Array) -> Array:
    """Covariance (n, n) scaled to a unit diagonal; rows without a variance are NaN."""
    spread = np.sqrt(np.where(np.diag(covariance) > 0, np.diag(covariance), np.nan))
    return covariance / np.outer(spread, spread)


def heat_map(names: Sequence[str], covariance: Array, prefix: str) -> str:
    """Lower triangle, numbers in the cells where they fit; empty for fewer than two coefficients."""
    n = len(names)
    if n < 2 or covariance.shape != (n, n):
        return ""
    matrix = correlation_of(covariance)
    lower = np.where(np.tri(n, k=-1, dtype=bool), matrix, np.nan)[1:, :-1]
    size = float(np.clip(0.36 * n + 0.9, 3.0, WIDTH))
    with styled():
        figure = canvas(size * 0.92, size)
        axes = figure.add_subplot()
        axes.grid(visible=False)
        axes.pcolormesh(lower, cmap="RdBu_r", vmin=-1, vmax=1, edgecolors="white", linewidth=0.8)
        axes.set_xlim(0, n - 1)
        axes.set_ylim(n - 1, 0)
        axes.set_xticks(np.arange(n - 1) + 0.5, names[:-1], rotation=90)
        axes.set_yticks(np.arange(n - 1) + 0.5, names[1:])
        axes.tick_params(length=0, labelsize=7 if n <= NUMBERED else 5.5)
        for spine in axes.spines.values():
            spine.set_visible(False)
        if n <= NUMBERED:
            for i, j in zip(*np.nonzero(np.isfinite(lower)), strict=True):
                value = lower[i, j]
                axes.text(j + 0.5, i + 0.5, f"{value:.2f}".replace("-", "\u2212").replace("0.", "."), ha="center",
                          va="center", size=5.6, color="white" if abs(value) > 0.65 else "#333333")  # fmt: skip
        return svg(figure, "correlations between the free coefficients", prefix)
