"""Panels, axes, marks and ticks of a figure."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.figures.chart import (
    WIDTH,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Marker,
    Panel,
    Region,
    Shape,
    Stroke,
    decade_ticks,
    decimated,
    linear_ticks,
    row_axis,
    span,
    thinned,
    tiles,
    whole_decades,
)

# Legends move the panels down, axes place values to scale, and panels know the room that their ticks take.

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


# Ticks are round numbers within the range; ranges enclose what is finite; curves of fewer points keep what matters.


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-37.0, 41.0), (0.66, 1.21), (-3e-4, 2e-4), (0.0, 2075.0)])
@pytest.mark.parametrize("count", [2, 4, 8])
def test_linear_ticks_are_equidistant_within_the_range_and_about_as_many(low: float, high: float, count: int) -> None:
    values = [tick.value for tick in linear_ticks(low, high, count)]
    assert all(low - 1e-9 <= v <= high + 1e-9 for v in values)
    assert max(2, count / 2) <= len(values) <= 2 * count
    assert np.ptp(np.diff(values)) < 1e-9 * (high - low)


def test_a_tick_has_a_true_minus_and_rounding_is_zero() -> None:
    assert [tick.text for tick in linear_ticks(-0.3, 0.3, 7)] == ["−0.3", "−0.2", "−0.1", "0", "0.1", "0.2", "0.3"]
    assert [tick.text for tick in linear_ticks(2.0, 2.0, 4)] == ["2"]


def test_decades_have_steps_between_them_where_they_are_few_and_are_skipped_where_many() -> None:
    assert [t.text for t in decade_ticks(0.01, 30.0, 4)] == ["0.01", "0.1", "1", "10"]
    assert [t.text for t in decade_ticks(1.0, 30.0, 5)] == ["1", "2", "5", "10", "20"]
    assert len(decade_ticks(1e-12, 1e12, 5)) <= 10


def test_constant_and_empty_values_have_a_range() -> None:
    for values in (np.full(9, 3.0), np.zeros(9), np.full(9, np.nan)):
        low, high = span([values])
        assert high > low
    assert span([np.array([0.0, np.nan, 10.0])], 0.1) == (-1.0, 11.0)


def test_whole_decades_enclose_values_and_the_least_range() -> None:
    assert whole_decades([0.3, 70.0], (1.0, 10.0)) == pytest.approx((0.1, 100.0))
    assert whole_decades([], (1.0, 1000.0)) == pytest.approx((1.0, 1000.0))


def test_decimation_keeps_extremes_order_and_gaps(rng: np.random.Generator) -> None:
    x = np.arange(10_000.0)
    y = rng.standard_normal(10_000)
    y[5_000:6_000] = np.nan
    a, b = decimated(x, y, 400)
    assert len(a) <= 400 and np.all(np.diff(a) >= 0)
    assert np.nanmax(b) == np.nanmax(y) and np.nanmin(b) == np.nanmin(y)
    assert np.isnan(b[(a > 5_050) & (a < 5_950)]).all()


def test_thinning_keeps_both_ends_and_short_curves_whole() -> None:
    x = np.arange(1_000.0)
    a, b = thinned(x, 2.0 * x, 50)
    assert len(a) == 50 and (a[0], a[-1]) == (0.0, 999.0) and np.array_equal(b, 2.0 * a)
    assert len(thinned(x[:9], x[:9], 50)[0]) == 9
