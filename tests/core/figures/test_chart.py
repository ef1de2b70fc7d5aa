"""Legends wrap at the width of the chart and move the panels down."""

import numpy as np

from seatrial.core.figures.chart import Axis, Chart, LegendEntry, Panel, Region
from seatrial.core.figures.marks import Line, Marker, Shape, Stroke

LINE = Line(np.arange(2.0), np.arange(2.0), Stroke("#000000", 1.0))
PANEL = Panel(Region(64.0, 0.0, 400.0, 100.0), Axis((0.0, 1.0), "x"), Axis((0.0, 1.0)), (LINE,))


def entries(count: int) -> tuple[LegendEntry, ...]:
    return tuple(LegendEntry(f"a name of some length, {k}", Marker(Shape.CIRCLE, 3.0, "#000000")) for k in range(count))


def test_a_legend_begins_at_the_first_panel_and_wraps() -> None:
    positions = Chart("c", (PANEL,), entries(9)).legend_positions()
    assert positions[0].left == 64.0 and {p.left for p in positions if p.top > positions[0].top} >= {64.0}
    assert all(p.left < 864.0 for p in positions)


def test_every_line_of_legend_makes_the_chart_higher() -> None:
    heights = [Chart("c", (PANEL,), entries(count)).height() for count in (0, 1, 9)]
    assert heights[0] < heights[1] < heights[2]
    assert Chart("c", (PANEL,)).legend_height() == 0.0


def test_the_height_holds_ticks_and_name() -> None:
    assert Chart("c", (PANEL,)).height() >= 100.0 + PANEL.depth() > 110.0
