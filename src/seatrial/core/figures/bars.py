"""Grouped bars of a study: a group for each label, a shade for each series."""

import math

from seatrial.core.figures.plot import (
    ACCENT,
    AXIS,
    FAINT,
    GREY,
    INK,
    SECOND,
    WIDTH,
    Panel,
    Stroke,
    drawing,
    rectangle,
    segment,
    text,
    tick_text,
    ticks,
)  # fmt: skip
from seatrial.core.results import Bars
from seatrial.core.text.numbers import DASH, exact

# dark and pale in turn, so that neighbours differ without colour
SHADES = (ACCENT, "#a9bccb", SECOND, "#e6c4b8", "#5d676f", "#d8c48e", "#2e7d5b", GREY)
HEIGHT, LEFT = 230.0, 64.0
GROUP, WIDEST_BAR = 0.82, 34.0
_LETTER, _DECADES = 6.1, 9


def bars(chart: Bars) -> str:
    """One figure with its legend above; what has no bar is marked: a dash for none, 0 or ∞. Empty without values."""
    if not chart.labels or not chart.series:
        return ""
    legend, top = _legend(tuple(chart.series))
    panel = _panel(chart, top)
    parts = [legend, _axis(panel, chart)]
    for k in range(len(chart.labels)):
        parts += _group(panel, chart, k)
    base = float(panel.py(panel.y[0] if chart.is_logarithmic else 0.0))
    parts.append(segment(panel.left_edge, base, panel.left_edge + panel.width, base, Stroke(AXIS, 0.9)))
    names, depth = _labels(panel, chart.labels)
    return drawing([*parts, names], panel.top + panel.height + depth, chart.title)


def _panel(chart: Bars, top: float) -> Panel:
    values = [v for row in chart.series.values() for v in row if v is not None and math.isfinite(v)]
    if chart.is_logarithmic:
        powers = [math.log10(v) for v in values if v > 0.0] or [0.0]
        low, high = math.floor(min(powers) - 0.1), math.ceil(max(powers) + 0.02)
        ends = (float(low), float(max(high, low + 1)))
    else:
        low, high = min([0.0, *values]), max([0.0, *values])
        room = 0.06 * (high - low) or 1.0
        ends = (low - room if low < 0.0 else 0.0, high + room if high > 0.0 or low == 0.0 else 0.0)
    return Panel(LEFT, top, WIDTH - LEFT - 8, HEIGHT, (-0.5, len(chart.labels) - 0.5), ends)


def _axis(panel: Panel, chart: Bars) -> str:
    right, parts = panel.left_edge + panel.width, []
    for value in _decades(panel.y) if chart.is_logarithmic else ticks(*panel.y, 5):
        y = float(panel.py(value))
        words = exact(10.0**value) if chart.is_logarithmic else tick_text(value, panel.y)
        parts.append(segment(panel.left_edge, y, right, y, Stroke(FAINT, 0.8)))
        parts.append(text(panel.left_edge - 5, y + 3.6, words, anchor="end", size=10))
    parts.append(segment(panel.left_edge, panel.top, panel.left_edge, panel.top + panel.height, Stroke(AXIS, 0.8)))
    parts.append(text(14, panel.top + panel.height / 2, chart.unit, anchor="middle", turn=-90))
    return "".join(parts)


def _decades(ends: tuple[float, float]) -> list[float]:
    """Whole powers of ten, every second or third where there are many."""
    low, high = round(ends[0]), round(ends[1])
    return [float(power) for power in range(low, high + 1, 1 + (high - low) // _DECADES)]


def _group(panel: Panel, chart: Bars, k: int) -> list[str]:
    """The bars of one label, side by side about its place."""
    count = len(chart.series)
    width = min(WIDEST_BAR, GROUP * panel.width / len(chart.labels) / count)
    first = float(panel.px(k)) - 0.5 * width * count
    base = panel.y[0] if chart.is_logarithmic else 0.0
    parts = []
    for j, row in enumerate(chart.series.values()):
        value, left = row[k], first + j * width
        mark = _mark(value, is_logarithmic=chart.is_logarithmic)
        if value is None or mark:
            at = float(panel.py(base)) - 4
            parts.append(text(left + width / 2, at, mark, anchor="middle", size=10, colour=INK))
            continue
        ends = sorted(float(panel.py(v)) for v in (base, math.log10(value) if chart.is_logarithmic else value))
        thick = max(width - 1.0, 0.8 * width)
        parts.append(rectangle(left, ends[0], thick, max(ends[1] - ends[0], 0.6), SHADES[j % len(SHADES)]))
    return parts


def _mark(value: float | None, *, is_logarithmic: bool) -> str:
    """What stands in a bar's place where none can be drawn; empty for a bar."""
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value):
        return "∞"
    return "0" if is_logarithmic and value == 0.0 else ""


def _labels(panel: Panel, labels: tuple[str, ...]) -> tuple[str, float]:
    """Names below the groups, upright where they do not fit side by side, and the room they take [px]."""
    bottom, longest = panel.top + panel.height, _LETTER * max(len(name) for name in labels)
    if longest <= 0.96 * panel.width / len(labels):
        drawn = [text(float(panel.px(k)), bottom + 16, name, anchor="middle") for k, name in enumerate(labels)]
        return "".join(drawn), 26.0
    drawn = [text(float(panel.px(k)) + 4, bottom + 8, name, anchor="end", turn=-90) for k, name in enumerate(labels)]
    return "".join(drawn), longest + 16


def _legend(names: tuple[str, ...]) -> tuple[str, float]:
    """A square of its shade before each name, in the order of the bars, and the room all take [px]; none for ""."""
    parts, left, top = [], LEFT, 5.0
    for j, name in enumerate(names):
        width = _LETTER * len(name) + 38
        if left > LEFT and left + width > WIDTH:
            left, top = LEFT, top + 18.0
        if name:
            parts.append(rectangle(left, top, 11, 11, SHADES[j % len(SHADES)]))
            parts.append(text(left + 16, top + 10, name))
        left += width
    return "".join(parts), top + 23.0
