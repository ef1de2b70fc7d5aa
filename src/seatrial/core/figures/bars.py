"""Grouped bars: a group for each label, a shade for each series."""

import math
from collections.abc import Iterator, Mapping, Sequence

from seatrial.core.figures.chart import WIDTH, Axis, Chart, LegendEntry, Panel, Region, row_axis
from seatrial.core.figures.marks import ACCENT, GREY, SECOND, Anchor, Mark, Rectangle, Rule, Stroke, Text
from seatrial.core.figures.ticks import MARGIN
from seatrial.core.text.numbers import DASH

# dark and pale in turn, so that neighbours differ without colour
SHADES = (ACCENT, "#a9bccb", SECOND, "#e6c4b8", "#5d676f", "#d8c48e", "#2e7d5b", GREY)
HEIGHT, LEFT = 230.0, 64.0  # px, chosen
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
    box = Region(LEFT, 6.0, WIDTH - LEFT - 8.0, HEIGHT)  # px, chosen
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
