"""Relative standard errors as dots over a logarithmic axis, a row for each coefficient or manoeuvre."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.figures.log_rows import ROW, decade_axis, decade_panel
from seatrial.core.figures.plot import ACCENT, FAINT, GREY, INK, WIDTH, Panel, Stroke, drawing, segment, text

LEAST = (1.0, 10.0)
LEGEND = 22.0
# per cent from which on a dot says no more than that nothing is told
NO_INFORMATION = 1e4


@dataclass(frozen=True)
class Dots:
    """Per cent for each row, several or none; `mark`: ``filled``, ``open`` or ``tick``."""

    name: str
    rows: Sequence[Sequence[float]]
    mark: str


def dots(names: Sequence[str], series: Sequence[Dots], axis_name: str) -> str:
    """A row for each name with the dots of every series, a legend above; empty for none."""
    known = [v for one in series for row in one.rows for v in row if 0.0 < v < NO_INFORMATION]
    if not names or not known:
        return ""
    panel = decade_panel(names, known, LEAST, LEGEND)
    parts = [decade_axis(panel, " %", axis_name), _legend(series)]
    for k, name in enumerate(names):
        y = float(panel.py(k))
        parts.append(segment(panel.left_edge, y, panel.left_edge + panel.width, y, Stroke(FAINT, 0.8)))
        parts.append(text(panel.left_edge - 8, y + 4, name, anchor="end", size=10.5))
        for one in series:
            parts += [_value_mark(panel, value, y, one.mark) for value in one.rows[k]]
    return drawing(parts, panel.top + ROW * len(names) + 38, axis_name)


def _legend(series: Sequence[Dots]) -> str:
    parts, right = [], WIDTH - 8.0
    for one in reversed(series):
        right -= 6.2 * len(one.name)
        parts.append(text(right, 12, one.name))
        parts.append(_mark(right - 9, 8, one.mark))
        right -= 30
    return "".join(parts)


def _value_mark(panel: Panel, value: float, y: float, mark: str) -> str:
    if math.isnan(value) or value <= 0:
        return ""
    if value >= NO_INFORMATION:
        return text(panel.left_edge + panel.width - 6, y + 4, "no information ▸", anchor="end", size=10.5, colour=GREY)
    return _mark(float(panel.px(math.log10(value))), y, mark)


def _mark(x: float, y: float, mark: str) -> str:
    if mark == "tick":
        return segment(x, y - 6, x, y + 6, Stroke(INK, 1.6))
    fill, edge, size = (ACCENT, ACCENT, 4.0) if mark == "filled" else ("#fff", "#6c7a89", 3.4)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size:g}" fill="{fill}" stroke="{edge}" stroke-width="1.4"/>'
