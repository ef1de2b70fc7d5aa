"""Charts of numbers: curves, grouped bars, rows with a name each, and heat maps."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    MARGIN,
    SECOND,
    WIDTH,
    Anchor,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Panel,
    Rectangle,
    Region,
    Rule,
    Stroke,
    Text,
    Tick,
    decimated,
    row_axis,
    span,
    text_width,
    thinned,
    whole_decades,
)
from seatrial.core.text.numbers import DASH, exact, fixed, significant

# Named curves over one pair of axes; line styles distinguish them without colour.

# px, chosen
STROKES = (
    Stroke(INK, 1.3), Stroke(ACCENT, 1.5, "6 3"), Stroke(SECOND, 1.5, "7 2 1.5 2"), Stroke("#6c7a89", 1.7, "1.5 2.5"),
    Stroke("#2e7d5b", 1.4, "9 2 1.5 2 1.5 2"), Stroke("#8e6c1f", 1.4, "3 1.5"), Stroke("#5b4a7a", 1.4, "1 4"),
)  # fmt: skip
# height of the panel [px], and of a map over that
HEIGHT, MAP_RATIO = 300.0, 1.4
LEFT = 64.0  # px, chosen


@dataclass(frozen=True, eq=False)
class NamedCurve:
    """A curve of arrays of equal length with its name in the legend."""

    name: str
    x: Array
    y: Array


def curves_chart(title: str, curves: Sequence[NamedCurve], x_name: str, y_name: str, *, is_map: bool = False) -> Chart:
    """Return curves with their legend; the axes of a map have equal scales."""
    x, y = span([c.x for c in curves]), span([c.y for c in curves])
    box = Region(LEFT, 8.0, WIDTH - LEFT - 8.0, HEIGHT)  # px, chosen
    if is_map:
        scale = max((x[1] - x[0]) / box.width, (y[1] - y[0]) / (MAP_RATIO * HEIGHT))
        box = Region(LEFT, 8.0, (x[1] - x[0]) / scale, (y[1] - y[0]) / scale)  # px, chosen
    sampled = thinned if is_map else decimated
    styled = [(c, STROKES[k % len(STROKES)]) for k, c in enumerate(curves)]
    lines = tuple(Line(*sampled(c.x, c.y), stroke) for c, stroke in styled)
    panel = Panel(box, Axis(x, x_name, tick_count=7), Axis(y, y_name, tick_count=6), lines)  # ticks, chosen
    return Chart(title, (panel,), tuple(LegendEntry(c.name, stroke) for c, stroke in styled))


# Grouped bars: a group for each label, a shade for each series.

# dark and pale in turn, so that neighbours differ without colour
SHADES = (ACCENT, "#a9bccb", SECOND, "#e6c4b8", "#5d676f", "#d8c48e", "#2e7d5b", GREY)
BARS_HEIGHT, BARS_LEFT = 230.0, 64.0  # px, chosen
# share of a group's width that its bars take, and the width of the widest bar [px]
GROUP, WIDEST_BAR = 0.82, 34.0
BASE = Stroke("#8a9299", 0.9)  # px, chosen


def bars_chart(
    title: str, labels: Sequence[str], series: Mapping[str, Sequence[float | None]], unit: str, *,
    is_logarithmic: bool = False,
) -> Chart | None:  # fmt: skip
    """Return bars with a legend; a dash, 0 or ∞ stands where there is no bar. None without values."""
    if not labels or not series:
        return None
    box = Region(BARS_LEFT, 6.0, WIDTH - BARS_LEFT - 8.0, BARS_HEIGHT)  # px, chosen
    finite = [v for row in series.values() for v in row if v is not None and math.isfinite(v)]
    y = _log_axis(finite, unit) if is_logarithmic else _linear_axis(finite, unit)
    base = y.ends[0] if is_logarithmic else 0.0
    width = min(WIDEST_BAR * len(labels) / box.width, GROUP / len(series))  # in groups
    marks = tuple(mark for j, row in enumerate(series.values())
                  for mark in _series(row, (j - 0.5 * len(series)) * width, width, base, SHADES[j % len(SHADES)],
                                      is_logarithmic=is_logarithmic))  # fmt: skip
    legend = tuple(LegendEntry(name, SHADES[j % len(SHADES)]) for j, name in enumerate(series) if name)
    return Chart(title, (Panel(box, row_axis(labels), y, (*marks, Rule(base, BASE))),), legend)


# decades of a logarithmic axis, ours: within what numbers of 64 bits can hold, with room for one more either way
_LEAST_POWER, _LARGEST_POWER = -300.0, 300.0


def _linear_axis(values: Sequence[float], unit: str) -> Axis:
    low, high = min([0.0, *values]), max([0.0, *values])
    free = MARGIN * (high - low) or 1.0
    return Axis((low - free if low < 0.0 else 0.0, high + free if high > 0.0 or low == 0.0 else 0.0), unit)


def _log_axis(values: Sequence[float], unit: str) -> Axis:
    """Whole decades; a smallest bar that would have no height gets one."""
    powers = [min(max(math.log10(v), _LEAST_POWER), _LARGEST_POWER) for v in values if v > 0.0] or [0.0]
    low, high = math.floor(min(powers) - 0.1), math.ceil(max(powers) + 0.02)  # px, chosen
    return Axis((10.0**low, 10.0 ** max(high, low + 1)), unit, is_logarithmic=True)


def _series(row: Sequence[float | None], start: float, width: float, base: float, shade: str, *,
            is_logarithmic: bool) -> Iterator[Mark]:  # fmt: skip
    """The bars of one series, each `start` to the right of its label's middle, in groups."""
    for k, value in enumerate(row):
        left = k + start
        sign = _sign_of_no_bar(value, is_logarithmic=is_logarithmic)
        if value is None or sign:
            yield Text(left + 0.5 * width, base, sign, Anchor.MIDDLE, 10.0, dy=-4.0)
        else:
            yield Rectangle(left, base, left + 0.95 * width, value, shade)  # px, chosen


def _sign_of_no_bar(value: float | None, *, is_logarithmic: bool) -> str:
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value):
        return "∞"
    return "0" if is_logarithmic and value == 0.0 else ""


# Panels with a name for each row: dots, bars or intervals over a common axis.

# height of a row [px]; share of the width that names take at most
ROW, MAX_NAME_SHARE = 18.0, 0.45
SMALL = 10.5  # px, chosen


# px, chosen
def row_panel(names: Sequence[str], x: Axis, marks: Sequence[Mark], *, top: float = 22.0, right: float = 24.0,
              has_grid: bool = False, width: float = WIDTH) -> Panel:  # fmt: skip
    """Return a panel whose row k lies at y = k, the first on top; `top` and `right` px are free beside it."""
    widest = max((text_width(name, SMALL) for name in names), default=0.0)
    left = min(MAX_NAME_SHARE * width, widest + 14.0)  # px, chosen
    box = Region(left, top, width - left - right, ROW * len(names))
    return Panel(box, x, row_axis(names, has_grid=has_grid), tuple(marks), is_y_down=True)


def decades_axis(values: Sequence[float], least: tuple[float, float], name: str, unit: str = "") -> Axis:
    """Return a logarithmic axis of whole decades about positive values, at least those of `least`."""
    low, high = (round(math.log10(end)) for end in whole_decades(values, least))
    ticks = tuple(Tick(10.0**power, exact(10.0**power) + unit) for power in range(low, high + 1))
    return Axis((10.0**low, 10.0**high), name, is_logarithmic=True, ticks=ticks)


def no_information(axis: Axis, row: int, colour: str = GREY) -> Text:
    """Return the note of a row whose value lies beyond any axis."""
    return Text(axis.ends[1], row, "no information ▸", Anchor.END, SMALL, colour, dx=-6.0, dy=4.0)


# Heat maps: a matrix as coloured cells with numbers where they fit; red above zero, blue below.

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
