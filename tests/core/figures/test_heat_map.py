"""Heat maps: colours turn at zero, numbers stand in the cells, cells without a value stay empty."""

import numpy as np
import pytest
from tests.core.figures.test_night import contrast

from seatrial.core.figures.chart import Chart
from seatrial.core.figures.heat_map import cell_text, colour, colour_key, heat_map, strength
from seatrial.core.figures.marks import INK, Rectangle, Text
from seatrial.core.figures.night import night_colour

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
