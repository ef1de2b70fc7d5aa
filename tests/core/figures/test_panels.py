"""Charts of numbers: curves, bars, rows, heat maps."""

import numpy as np
import pytest
from tests.core.figures.test_svg_text import contrast

from seatrial.core.figures.chart import INK, Chart, Rectangle, Text
from seatrial.core.figures.panels import (
    SHADES,
    NamedCurve,
    bars_chart,
    cell_text,
    colour,
    colour_key,
    curves_chart,
    decades_axis,
    heat_map,
    no_information,
    row_panel,
    strength,
)
from seatrial.core.figures.svg_text import night_colour

# Curves have styles that differ without colour; maps have equal scales.

X = np.linspace(0.0, 10.0, 5000)


def test_curves_have_a_style_each_and_few_points() -> None:
    chart = curves_chart("c", [NamedCurve("a", X, np.sin(X)), NamedCurve("b", X, np.cos(X))], "t [s]", "ψ [deg]")
    lines = chart.panels[0].marks
    assert len({line.stroke.dash for line in lines}) == 2 and all(len(line.x) <= 400 for line in lines)  # type: ignore[union-attr]
    assert [entry.words for entry in chart.legend] == ["a", "b"]


def test_a_map_has_equal_scales() -> None:
    panel = curves_chart("c", [NamedCurve("a", X, 3.0 * X)], "x", "y", is_map=True).panels[0]
    x, y = (np.diff(axis.ends)[0] for axis in (panel.x, panel.y))
    assert x / panel.box.width == pytest.approx(y / panel.box.height)


# Grouped bars: heights to scale on both axes, what has no bar is marked.


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


# Rows have room for their names, and an axis of whole decades.


def test_long_names_take_room_but_not_the_page() -> None:
    axis = decades_axis([3.0], (1.0, 10.0), "error", " %")
    short, long = (row_panel([name], axis, []) for name in ("Y_v", "a name " * 40))
    assert short.box.left < 50.0 < long.box.left < 0.5 * 864.0
    assert short.is_y_down and short.y.ends == (-0.5, 0.5)


def test_an_axis_has_a_tick_at_every_decade() -> None:
    axis = decades_axis([0.03, 700.0], (1.0, 10.0), "error", " %")
    assert axis.ends == pytest.approx((0.01, 1000.0))
    assert [tick.text for tick in axis.ticks or ()] == ["0.01 %", "0.1 %", "1 %", "10 %", "100 %", "1\u202f000 %"]
    assert no_information(axis, 2).x == axis.ends[1]


# Heat maps: colours turn at zero, numbers stand in the cells, cells without a value stay empty.

NAMES = ("X_uu", "Y_v", "N_r")


def cells(chart: Chart | None) -> list[Rectangle]:
    assert chart is not None
    return [mark for mark in chart.panels[0].marks if isinstance(mark, Rectangle)]


def words(chart: Chart | None) -> list[str]:
    assert chart is not None
    return [mark.words for mark in chart.panels[0].marks if isinstance(mark, Text)]


def test_colours_turn_at_zero_and_are_full_at_the_limit() -> None:
    assert colour(0.0, 1.0) == "#ffffff"
    assert colour(2.0, 2.0) == colour(9.0, 2.0) == "#e49288"
    assert colour(-2.0, 2.0) == "#94bedb"
    assert colour(float("nan"), 1.0) == "#f4f6f7"
    assert (strength(0.0, 1.0), strength(-3.0, 2.0), strength(float("nan"), 1.0)) == (0.0, 1.0, 0.0)


@pytest.mark.parametrize("value", np.linspace(-1.0, 1.0, 41))
def test_numbers_are_read_on_every_cell_by_day_and_by_night(value: float) -> None:
    cell = colour(float(value), 1.0)
    assert contrast(INK, cell) > 4.5 and contrast(night_colour(INK), night_colour(cell)) > 4.5


@pytest.mark.parametrize(
    ("value", "limit", "text"),
    [(0.974, 1.0, "0.97"), (-0.5, 1.0, "−0.50"), (1.0, 1.0, "1.00"), (-0.001, 1.0, "0.00"), (12.34, 20.0, "12")],
)
def test_numbers_in_cells(value: float, limit: float, text: str) -> None:
    assert cell_text(value, limit) == text


def test_every_cell_is_drawn_and_one_without_a_value_has_no_number() -> None:
    chart = heat_map("m", NAMES, ("v", "r"), np.array([[1.0, 0.25], [np.nan, -0.75], [0.0, 0.5]]))
    assert len(cells(chart)) == 6 and sum(cell.fill == "#f4f6f7" for cell in cells(chart)) == 1
    assert words(chart) == ["1.00", "0.25", "−0.75", "0.00", "0.50"]


def test_many_columns_are_drawn_without_numbers() -> None:
    chart = heat_map("m", NAMES, tuple(f"c{k}" for k in range(30)), np.full((3, 30), 0.25))
    assert len(cells(chart)) == 90 and words(chart) == []


def test_the_largest_value_is_the_limit_where_none_is_given() -> None:
    chart = heat_map("m", ("a",), ("b", "c"), np.array([[3.0, -7.0]]), None)
    assert cells(chart)[1].fill == colour(-7.0, 7.0)
    assert len(cells(heat_map("m", ("a",), ("b",), np.array([[np.nan]]), None))) == 1


def test_a_lower_triangle_has_no_key() -> None:
    chart = heat_map("m", NAMES, NAMES, np.eye(3), is_lower=True)
    assert len(cells(chart)) == 6 and chart is not None and len(chart.panels) == 1


def test_a_key_is_signed_where_values_are() -> None:
    texts = [m.words for m in colour_key(0.0, 2.0, is_signed=True).marks if isinstance(m, Text)]
    assert texts == ["2", "1", "0", "−1", "−2"]
    assert len(colour_key(0.0, 2.0, is_signed=False).marks) == 6


def test_without_cells_there_is_no_chart() -> None:
    assert heat_map("m", (), (), np.empty((0, 0))) is None
