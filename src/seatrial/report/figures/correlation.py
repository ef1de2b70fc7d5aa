"""Heat map of the correlations between the free coefficients' errors."""

from collections.abc import Sequence

import numpy as np

from seatrial.report.figures.plot import WIDTH, drawing, rectangle, text
from seatrial.values import Array

NUMBERED = 24
_RED, _BLUE = np.array([163, 48, 34]), np.array([27, 79, 114])


def correlation_of(covariance: Array) -> Array:
    """Covariance (n, n) scaled to a unit diagonal; rows without a variance are NaN."""
    spread = np.sqrt(np.where(np.diag(covariance) > 0, np.diag(covariance), np.nan))
    return covariance / np.outer(spread, spread)


def heat_map(names: Sequence[str], covariance: Array) -> str:
    """Lower triangle, numbers in the cells where they fit; empty for fewer than two coefficients."""
    n = len(names)
    if n < 2 or covariance.shape != (n, n):
        return ""
    matrix = correlation_of(covariance)
    size = float(np.clip((WIDTH - 110) / (n - 1), 9.0, 34.0))
    margin = 7.2 * max(len(name) for name in names) + 10
    parts = []
    for i in range(1, n):
        top = (i - 1) * size
        parts.append(text(margin - 6, top + size / 2 + 4, names[i], anchor="end", size=min(11.0, size)))
        for j in range(i):
            parts.append(_cell(margin + j * size, top, size, float(matrix[i, j]), numbered=n <= NUMBERED))
    bottom = (n - 1) * size
    for j in range(n - 1):
        at = margin + (j + 0.5) * size + 4
        parts.append(text(at, bottom + 8, names[j], anchor="end", size=min(11.0, size), turn=-90))
    return drawing(parts, bottom + margin, "correlations of the free coefficients", margin + (n - 1) * size + 4)


def _cell(left: float, top: float, size: float, value: float, *, numbered: bool) -> str:
    if not np.isfinite(value):
        return rectangle(left, top, size - 1, size - 1, "#f4f6f7")
    strength = min(1.0, abs(value)) ** 1.3
    red, green, blue = (255 - strength * (255 - (_RED if value > 0 else _BLUE))).astype(int)
    made = rectangle(left, top, size - 1, size - 1, f"#{red:02x}{green:02x}{blue:02x}")
    if not numbered:
        return made
    words = f"{value:.2f}".replace("-", "−").replace("0.", ".")
    colour = "#fff" if strength > 0.55 else "#333"
    return made + text(
        left + (size - 1) / 2, top + size / 2 + 3, words, anchor="middle", size=0.3 * size, colour=colour
    )
