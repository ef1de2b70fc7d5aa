"""Grouped bars: heights to scale on both axes, what has no bar is marked."""

import numpy as np
import pytest

from seatrial.core.figures.bars import SHADES, bars_chart
from seatrial.core.figures.chart import Chart
from seatrial.core.figures.marks import Rectangle, Text


def bars(chart: Chart | None) -> list[Rectangle]:
    assert chart is not None
    return [mark for mark in chart.panels[0].marks if isinstance(mark, Rectangle)]


def test_bars_stand_on_zero_and_negative_values_hang_below_it() -> None:
    up, down = bars(bars_chart("b", ("a", "c"), {"x": (4.0, -2.0)}, "%"))
    assert (up.bottom, up.top) == (0.0, 4.0) and (down.bottom, down.top) == (0.0, -2.0)
    assert (up.left + up.right) / 2 == pytest.approx(0.0, abs=0.05)
    assert (down.left + down.right) / 2 == pytest.approx(1.0, abs=0.05)


def test_a_logarithmic_axis_has_whole_decades_below_the_smallest_bar() -> None:
    chart = bars_chart("b", ("a", "c"), {"x": (1.0, 100.0)}, "1", is_logarithmic=True)
    assert chart is not None and chart.panels[0].y.ends == pytest.approx((0.1, 1000.0))
    assert all(bar.bottom == pytest.approx(0.1) for bar in bars(chart))


@pytest.mark.parametrize("value", [1e308, 5e-324])
def test_a_logarithmic_axis_holds_the_largest_and_the_smallest_number(value: float) -> None:
    chart = bars_chart("b", ("a",), {"x": (value,)}, "1", is_logarithmic=True)
    assert chart is not None
    low, high = chart.panels[0].y.ends
    assert 0.0 < low < high < float("inf") and np.isfinite(chart.panels[0].y.share(value))


def test_series_stand_side_by_side_in_shades_of_their_own() -> None:
    chart = bars_chart("b", ("a", "c"), {"x": (1.0, 2.0), "y": (3.0, 4.0)}, "1")
    first, _, second, _ = bars(chart)
    assert chart is not None and [entry.sample for entry in chart.legend] == list(SHADES[:2])
    assert (first.fill, second.fill) == SHADES[:2] and first.right < second.left


@pytest.mark.parametrize(("value", "sign"), [(None, "–"), (float("nan"), "–"), (float("inf"), "∞"), (0.0, "0")])
def test_what_has_no_bar_is_marked(value: float | None, sign: str) -> None:
    chart = bars_chart("b", ("a", "c"), {"x": (value, 3.0)}, "1", is_logarithmic=True)
    assert chart is not None and len(bars(chart)) == 1
    assert [mark.words for mark in chart.panels[0].marks if isinstance(mark, Text)] == [sign]


def test_without_values_there_is_no_chart() -> None:
    assert bars_chart("b", (), {}, "1") is None
