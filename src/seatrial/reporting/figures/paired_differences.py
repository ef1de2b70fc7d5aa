"""Differences between controllers over the same seas, with their intervals."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import ACCENT, Axis, Chart, Line, Mark, Marker, Points, Rule, Shape, Stroke, Text, span
from seatrial.core.figures.panels import SMALL, row_panel
from seatrial.core.results.tuning import PairedDifference
from seatrial.core.text.numbers import fixed
from seatrial.core.text.words import counted

STAGE_LABELS = {"linear": "without limits", "limited": "with limits", "stalled": "with stall, too"}
_BAR, _ZERO = Stroke(ACCENT, 1.8), Stroke("#8a9299", 1.2)  # px, chosen
# px, chosen
_END, _MEAN = Marker(Shape.UPRIGHT, 4.0, ACCENT, edge_width=1.8), Marker(Shape.CIRCLE, 3.6, ACCENT, ACCENT, 0.0)


def difference_chart(differences: Sequence[PairedDifference]) -> Chart | None:
    """Return a row for each comparison: mean and interval in points of reduction; None for none."""
    if not differences:
        return None
    marks: list[Mark] = [Rule(0.0, _ZERO, is_vertical=True)]
    # px and shares, chosen
    ends = span([np.array([100.0 * x for p in differences for x in (p.lower, p.upper, 0.0)])], 0.08)
    for row, p in enumerate(differences):
        lower, mean, upper = (100.0 * share for share in (p.lower, p.mean, p.upper))
        words = f"{fixed(mean, 1)} [{fixed(lower, 1)}, {fixed(upper, 1)}], {counted(p.seeds, 'seed')}"
        interval, rows = np.array([lower, upper]), np.full(2, float(row))
        marks += [Line(interval, rows, _BAR), Points(interval, rows, _END), Points(np.array([mean]), rows[:1], _MEAN),
                  Text(ends[1], row, words, size=SMALL, dx=10.0, dy=4.0)]  # fmt: skip
    names = [f"over {p.baseline}, {STAGE_LABELS.get(p.stage, p.stage)}" for p in differences]
    # px and ticks, chosen
    panel = row_panel(names, Axis(ends, "points of reduction", tick_count=6), marks, top=4.0, right=190.0)
    return Chart("paired differences", (panel,))
