"""A row of dots for each estimator over a logarithmic axis: how far each coefficient is off, the median marked."""

import math
from collections.abc import Mapping
from dataclasses import replace
from statistics import median

from seatrial.core.figures.log_rows import decade_axis, decade_panel
from seatrial.core.figures.plot import ACCENT, FAINT, GREY, INK, SECOND, Stroke, drawing, segment, text

LEAST = 0.1
_ROOM = 56.0
_TICK = Stroke(INK, 2.0)


def scatter(rows: Mapping[str, Mapping[str, tuple[float, bool]]], label: str) -> str:
    """Rows of name -> (size above 0, whether it is near: filled); sizes below `LEAST` stand at the left edge.

    The largest of each row is named. Empty for no rows.
    """
    if not rows:
        return ""
    sizes = [max(LEAST, size) for row in rows.values() for size, _ in row.values()]
    panel = decade_panel(list(rows), sizes, (LEAST, 100.0), 6.0)
    panel = replace(panel, width=panel.width - _ROOM)
    parts = [decade_axis(panel, " %", label)]
    for k, (name, row) in enumerate(rows.items()):
        y = float(panel.py(k))
        at = {one: float(panel.px(math.log10(max(LEAST, size)))) for one, (size, _) in row.items()}
        parts.append(text(panel.left_edge - 8, y + 4, name, anchor="end", size=10.5))
        parts.append(segment(panel.left_edge, y, panel.left_edge + panel.width, y, Stroke(FAINT, 0.8)))
        parts.append(segment(min(at.values()), y, max(at.values()), y, Stroke(GREY, 0.7)))
        parts += [_dot(at[one], y, is_near=near) for one, (_, near) in row.items()]
        middle = float(panel.px(math.log10(max(LEAST, median(size for size, _ in row.values())))))
        parts.append(segment(middle, y - 7, middle, y + 7, _TICK))
        worst = max(row, key=lambda one, row_sizes=row: row_sizes[one][0])
        parts.append(text(at[worst] + 7, y + 3.5, worst, size=9, colour=SECOND))
    return drawing(parts, panel.top + panel.height + 38, label)


def _dot(x: float, y: float, *, is_near: bool) -> str:
    """Filled near the fit, an open ring otherwise: told apart without colour."""
    fill, edge = (ACCENT, ACCENT) if is_near else ("#fff", SECOND)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{fill}" stroke="{edge}" stroke-width="1.2"/>'
