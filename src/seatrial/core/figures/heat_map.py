"""Heat maps: a matrix as coloured cells with numbers where they fit; red above zero, blue below."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import WIDTH, Axis, Chart, Panel, Region, row_axis
from seatrial.core.figures.marks import Anchor, Array, Mark, Rectangle, Text, text_width
from seatrial.core.text.numbers import exact, fixed, significant

# numbers are left out from this number of columns on
MAX_NUMBERED_COLUMNS = 24
# side of a cell [px]
SMALLEST, LARGEST = 9.0, 34.0
# colours (red, green, blue) of a value at the limit and at minus the limit, on which ink is read by day and night, and
# of a cell without a value
_RED, _BLUE, _EMPTY = np.array([228, 146, 136]), np.array([148, 190, 219]), "#f4f6f7"
# exponent that keeps small values pale
GAMMA = 1.3
# side of a square of the key, and the width that the key takes [px]
KEY_SIZE, KEY_WIDTH = 13.0, 78.0


def heat_map(title: str, rows: Sequence[str], columns: Sequence[str], values: Array, limit: float | None = 1.0, *,
             is_lower: bool = False) -> Chart | None:  # fmt: skip
    """Return the cells of a matrix (rows, columns) with names and a key of colours; None without cells.

    Args:
        limit: magnitude at which the colour is full; None: the largest.
        is_lower: only the lower triangle with the diagonal is drawn, without a key.
    """
    if values.size == 0:
        return None
    full = limit if limit is not None else float(np.abs(values[np.isfinite(values)]).max(initial=0.0)) or 1.0
    left = max(text_width(name) for name in rows) + 12.0  # px, chosen
    side = float(np.clip((WIDTH - left - KEY_WIDTH) / len(columns), SMALLEST, LARGEST))
    box = Region(left, 0.0, side * len(columns), side * len(rows))
    inside = np.tri(*values.shape, dtype=bool) if is_lower else np.ones(values.shape, dtype=bool)
    marks = [
        m
        for i, j in np.argwhere(inside)
        for m in _cell(int(i), int(j), float(values[i, j]), full, side, has_number=len(columns) <= MAX_NUMBERED_COLUMNS)
    ]
    # px, chosen
    panel = Panel(box, row_axis(columns), row_axis(rows), tuple(marks), is_y_down=True,
                  tick_size=min(11.0, side), has_lines=False)  # fmt: skip
    if is_lower:
        return Chart(title, (panel,), width=box.right + 4.0)
    return Chart(
        title,
        (panel, colour_key(box.right + 14.0, full, is_signed=bool(np.any(values < 0.0)))),  # px, chosen
        width=box.right + KEY_WIDTH,
    )


def colour(value: float, limit: float) -> str:
    """Return the fill of a cell."""
    if not np.isfinite(value):
        return _EMPTY
    red, green, blue = (255 - strength(value, limit) * (255 - (_RED if value > 0 else _BLUE))).astype(int)  # px, chosen
    return f"#{red:02x}{green:02x}{blue:02x}"


def strength(value: float, limit: float) -> float:
    """Return the strength of a cell's colour from 0 (white, or no value) to 1."""
    return min(1.0, abs(value) / limit) ** GAMMA if np.isfinite(value) else 0.0


def cell_text(value: float, limit: float) -> str:
    """Return two decimals up to a limit of one, else two significant digits."""
    return fixed(value, 2) if limit <= 1.0 else significant(value, 2)


def _cell(row: int, column: int, value: float, limit: float, side: float, *, has_number: bool) -> list[Mark]:
    square = Rectangle(column - 0.5, row - 0.5, column + 0.5, row + 0.5, colour(value, limit), gap=1.0)
    if not has_number or not np.isfinite(value):
        return [square]
    words = cell_text(value, limit)
    # px, chosen
    return [square, Text(column, row, words, Anchor.MIDDLE, 0.3 * side, dx=-0.5, dy=3.0)]


def colour_key(left: float, limit: float, *, is_signed: bool, top: float = 0.0) -> Panel:
    """Return squares from full red to white, on to full blue if signed, with their values at the right."""
    shares = (1.0, 0.5, 0.0, -0.5, -1.0) if is_signed else (1.0, 0.5, 0.0)
    marks: list[Mark] = []
    for k, share in enumerate(shares):
        marks.append(Rectangle(0.0, k, 1.0, k + 1.0, colour(share * limit, limit), gap=1.0))
        marks.append(Text(1.0, k + 1.0, exact(share * limit, 2), size=10.0, dx=4.0, dy=-3.0))
    box = Region(left, top, KEY_SIZE, KEY_SIZE * len(shares))
    return Panel(box, Axis((0.0, 1.0)), Axis((0.0, float(len(shares)))), tuple(marks), is_y_down=True, has_frame=False)
