"""Heat maps: a matrix as coloured cells with numbers where they fit; red above zero, blue below."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.plot import WIDTH, drawing, rectangle, text
from seatrial.core.results import Matrix
from seatrial.core.text.numbers import MINUS, exact, significant
from seatrial.core.values import Array

MOST_NUMBERED_COLUMNS = 24
SMALLEST, LARGEST = 9.0, 34.0
_RED, _BLUE = np.array([163, 48, 34]), np.array([27, 79, 114])
_EMPTY = "#f4f6f7"
_LETTER = 7.2
_KEY, _KEY_WIDTH = 13.0, 78.0


def matrix(heat_map: Matrix) -> str:
    """All cells of a matrix with its names and the key of its colours; empty for a matrix without cells."""
    if heat_map.values.size == 0:
        return ""
    limit = full_colour(heat_map)
    parts, right, bottom = cells(heat_map.rows, heat_map.columns, heat_map.values, limit)
    key, low = _key(right + 14.0, limit, is_signed=bool(np.any(heat_map.values < 0.0)))
    return drawing([*parts, key], max(bottom, low), heat_map.title, right + _KEY_WIDTH)


def full_colour(heat_map: Matrix) -> float:
    """Magnitude at which the colour is full."""
    if heat_map.limit is not None:
        return heat_map.limit
    known = np.abs(heat_map.values[np.isfinite(heat_map.values)])
    return float(known.max(initial=0.0)) or 1.0


def cells(
    rows: Sequence[str], columns: Sequence[str], values: Array, limit: float = 1.0, is_drawn: Array | None = None
) -> tuple[list[str], float, float]:
    """Cells and names of a matrix (rows, columns) as SVG parts, their right end and their bottom [px].

    is_drawn: cells that are drawn at all, of the same shape; cells of NaN are drawn empty.
    """
    margin = _LETTER * max(len(name) for name in rows) + 10
    size = float(np.clip((WIDTH - margin - _KEY_WIDTH) / len(columns), SMALLEST, LARGEST))
    letters, bottom = min(11.0, size), len(rows) * size
    parts = []
    for i, name in enumerate(rows):
        parts.append(text(margin - 6, i * size + size / 2 + 4, name, anchor="end", size=letters))
        for j in range(len(columns)):
            if is_drawn is None or is_drawn[i, j]:
                numbered = len(columns) <= MOST_NUMBERED_COLUMNS
                parts.append(_cell(margin + j * size, i * size, size, float(values[i, j]), limit, numbered=numbered))
    longest = _LETTER * max(len(name) for name in columns)
    for j, name in enumerate(columns):
        middle = margin + (j + 0.5) * size
        if longest <= size:
            parts.append(text(middle, bottom + 14, name, anchor="middle", size=letters))
        else:
            parts.append(text(middle + 4, bottom + 8, name, anchor="end", size=letters, turn=-90))
    return parts, margin + len(columns) * size, bottom + (22 if longest <= size else longest + 10)


def colour(value: float, limit: float) -> tuple[str, float]:
    """Fill of a cell, and its strength from 0 (white) to 1."""
    if not np.isfinite(value):
        return _EMPTY, 0.0
    strength = min(1.0, abs(value) / limit) ** 1.3
    red, green, blue = (255 - strength * (255 - (_RED if value > 0 else _BLUE))).astype(int)
    return f"#{red:02x}{green:02x}{blue:02x}", strength


def number(value: float, limit: float) -> str:
    """Two decimals without the leading zero up to one, else two significant digits."""
    if limit > 1.0:
        return significant(value, 2)
    return f"{value:.2f}".replace("-0.00", "0.00").replace("-", MINUS).replace("0.", ".")


def _cell(left_edge: float, top: float, size: float, value: float, limit: float, *, numbered: bool) -> str:
    fill, strength = colour(value, limit)
    made = rectangle(left_edge, top, size - 1, size - 1, fill)
    if not numbered or not np.isfinite(value):
        return made
    words, ink = number(value, limit), "#fff" if strength > 0.55 else "#333"
    return made + text(
        left_edge + (size - 1) / 2, top + size / 2 + 3, words, anchor="middle", size=0.3 * size, colour=ink
    )


def _key(left_edge: float, limit: float, *, is_signed: bool) -> tuple[str, float]:
    """Colours from full red to white, on to full blue if signed, with their values, and where they end [px]."""
    parts = []
    shares = (1.0, 0.5, 0.0, -0.5, -1.0) if is_signed else (1.0, 0.5, 0.0)
    for k, share in enumerate(shares):
        parts.append(rectangle(left_edge, k * _KEY, _KEY - 1, _KEY - 1, colour(share * limit, limit)[0]))
        parts.append(text(left_edge + _KEY + 4, k * _KEY + 10, exact(share * limit, 2), size=10))
    return "".join(parts), len(shares) * _KEY
