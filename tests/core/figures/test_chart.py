"""Legends move the panels down, axes place values to scale, and panels know the room that their ticks take."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.figures.chart import WIDTH, Axis, Chart, LegendEntry, Panel, Region, row_axis, tiles
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


BOX = Region(10.0, 20.0, 100.0, 50.0)


def test_values_grow_upwards_or_downwards() -> None:
    up = Panel(BOX, Axis((0.0, 4.0)), Axis((0.0, 1.0)))
    assert up.px(np.array([0.0, 1.0, 4.0])) == pytest.approx([10.0, 35.0, 110.0])
    assert up.py(np.array([0.0, 1.0])) == pytest.approx([70.0, 20.0])
    assert replace(up, is_y_down=True).py(np.array([0.0, 1.0])) == pytest.approx([20.0, 70.0])


def test_a_logarithmic_axis_has_equal_decades_and_no_place_for_what_is_not_positive() -> None:
    axis = Axis((0.1, 1000.0), is_logarithmic=True)
    assert axis.share(np.array([0.1, 1.0, 10.0, 1000.0])) == pytest.approx([0.0, 0.25, 0.5, 1.0])
    assert np.isnan(axis.share(np.array([-1.0, 0.0, np.nan]))).all()


def test_names_that_do_not_fit_side_by_side_are_turned_and_take_more_room() -> None:
    short = Panel(BOX, row_axis(("a", "b")), Axis((0.0, 1.0)))
    long = replace(short, x=row_axis(("a rather long name", "another")))
    assert not short.has_turned_labels() and long.has_turned_labels()
    assert long.depth() > short.depth() > 0.0
    assert replace(long, has_frame=False).depth() == 0.0


def test_tiles_fill_the_page_row_by_row_without_overlap() -> None:
    first, second, third = tiles(3, 2, 100.0, start=64.0, left=50.0, right=10.0, gap=20.0, top=5.0)
    assert (first.left, first.top, third.top) == (114.0, 5.0, 125.0)
    assert second.left == first.right + 60.0 and second.right == WIDTH - 10.0
    assert third.left == first.left
