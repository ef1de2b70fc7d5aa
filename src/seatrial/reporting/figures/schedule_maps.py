"""A gain schedule as maps: heading by speed for each wave height, compared with other gains; red: little is gained."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.figures.chart import (
    INK,
    WIDTH,
    Anchor,
    Chart,
    Line,
    Mark,
    Panel,
    Rectangle,
    Region,
    Stroke,
    Text,
    row_axis,
)
from seatrial.core.figures.panels import colour, colour_key
from seatrial.core.results.tuning import OperatingPoint
from seatrial.core.text.numbers import DASH, exact, fixed

THIS_SCHEDULE = "this schedule"
# room for speeds at the left, the key at the right, and between two maps [px]
LEFT, KEY, GAP = 66.0, 64.0, 14.0
# sides of a cell [px], its height over its width
WIDEST, LOWEST, HIGHEST, CELL_RATIO = 54.0, 22.0, 34.0, 0.62
_LACKING = Stroke(INK, 1.6)  # px, chosen


def schedule_chart(points: Sequence[OperatingPoint]) -> Chart | None:
    """Return a row of maps for each wave height, a column for the schedule and for each of the others.

    A cell is underlined where no gains are feasible. None without operating points.
    """
    if not points:
        return None
    names = [THIS_SCHEDULE, *points[0].baseline_costs]
    heights, headings = sorted({p.height for p in points}), sorted({p.beta for p in points})
    speeds = sorted({p.U for p in points}, reverse=True)
    wide = min(WIDEST, ((WIDTH - LEFT - KEY) / len(names) - GAP) / len(headings))
    size = (wide * len(headings), min(HIGHEST, max(LOWEST, CELL_RATIO * wide)) * len(speeds))
    columns = row_axis([exact(math.degrees(beta), 3) for beta in headings])
    rows = row_axis([exact(U, 3) for U in speeds])
    panels, top = [], 40.0  # px, chosen
    for height in heights:
        is_last = height == heights[-1]
        for k, name in enumerate(names):
            marks = [m for p in points if p.height == height
                     for m in _cell(p, name, headings.index(p.beta), speeds.index(p.U))]  # fmt: skip
            # px, chosen
            marks += [Text(-0.5, -0.5, f"{exact(height, 3)} m", Anchor.END, dx=-5.0, dy=-6.0)] if k == 0 else []
            x = replace(columns, name="heading [deg]" if is_last else "", has_labels=is_last)
            y = replace(rows, name="speed [m/s]" if k == 0 else "", has_labels=k == 0)
            box = Region(LEFT + k * (size[0] + GAP), top, *size)
            panels.append(Panel(box, x, y, tuple(marks), name if height == heights[0] else "", is_y_down=True,
                                has_lines=False))  # fmt: skip
        top += size[1] + 26.0  # px, chosen
    key = colour_key(LEFT + len(names) * (size[0] + GAP) + 4.0, 1.0, is_signed=False, top=40.0)  # px, chosen
    return Chart("costs of the schedule", (*panels, key))


def _cell(point: OperatingPoint, name: str, column: int, row: int) -> list[Mark]:
    cost = point.cost if name == THIS_SCHEDULE else point.baseline_costs.get(name, math.nan)
    words = "unst." if math.isinf(cost) else DASH if math.isnan(cost) else fixed(cost, 2)
    marks: list[Mark] = [
        Rectangle(column - 0.5, row - 0.5, column + 0.5, row + 0.5, colour(cost, 1.0), gap=1.5),  # px, chosen
        Text(column, row, words, Anchor.MIDDLE, 10.5, dx=-1.0, dy=3.5),  # px, chosen
    ]
    if name == THIS_SCHEDULE and not point.is_feasible:
        marks.append(Line(np.array([column - 0.45, column + 0.42]), np.full(2, row + 0.38), _LACKING))  # px, chosen
    return marks
