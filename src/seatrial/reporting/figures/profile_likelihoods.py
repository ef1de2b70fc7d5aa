"""Profile likelihoods: what the records lose when one coefficient is held at another value."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.figures.chart import Chart
from seatrial.core.figures.marks import ACCENT, SECOND, Anchor, Line, Rule, Stroke, Text
from seatrial.core.figures.panel import Axis, Panel, Region, tiles
from seatrial.core.results import Profile
from seatrial.core.values import display_unit
from seatrial.core.values.channel_text import unit_text

COLUMNS, HEIGHT = 3, 120.0
# 95 % quantile of chi-squared with one degree of freedom, and the highest loss drawn
BOUND, HIGHEST = 3.84, 12.0


def profile_chart(profiles: Sequence[Profile], units: Mapping[str, str]) -> Chart | None:
    """Return a panel for each coefficient with its bound of 95 %; None for none.

    Args:
        units: parameter -> SI unit.
    """
    usable = [p for p in profiles if len(p.values) > 1 and min(p.values) < max(p.values)]
    if not usable:
        return None
    boxes = tiles(len(usable), COLUMNS, HEIGHT, left=54.0, right=10.0, gap=46.0)
    panels = tuple(_panel(p, units.get(p.parameter, "1"), box) for p, box in zip(usable, boxes, strict=True))
    return Chart("profile likelihoods", panels)


def _panel(profile: Profile, unit: str, box: Region) -> Panel:
    factor, unit_shown = display_unit(unit)[0], unit_text(unit)
    values, costs = np.array(profile.values) * factor, np.array(profile.costs)
    order = np.argsort(values)
    highest = float(np.clip(1.05 * np.nanmax(costs), 1.3 * BOUND, HIGHEST))  # the bound is always visible
    x = Axis((float(values.min()), float(values.max())), tick_count=3)
    marks = [
        Rule(BOUND, Stroke(SECOND, 1.0, "4 2.5")),
        Text(x.ends[1], BOUND, "95 %", Anchor.END, 9.5, SECOND, dx=-2.0, dy=-4.0),
        Line(values[order], np.where(costs <= highest, costs, np.nan)[order], Stroke(ACCENT, 1.6)),
        *(Line(np.full(2, end * factor), np.array([0.0, BOUND]), Stroke(SECOND, 0.8))
          for end in (profile.lower, profile.upper) if end is not None),
    ]  # fmt: skip
    name = f"{profile.parameter} [{unit_shown}]" if unit_shown else profile.parameter
    return Panel(box, x, Axis((0.0, highest), "χ² lost", tick_count=3), tuple(marks), name)
