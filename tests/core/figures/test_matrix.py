"""Heat maps: colours turn at zero, numbers stand in the cells, empty cells stay empty, names have their cells."""

import re

import numpy as np
import pytest

from seatrial.core.figures.correlation import heat_map
from seatrial.core.figures.matrix import colour, full_colour, matrix, number
from seatrial.core.results import Matrix
from seatrial.core.values import InputError

NAMES = ("X_uu", "Y_v", "N_r")


def test_colours_turn_at_zero_and_are_full_at_the_limit() -> None:
    assert colour(0.0, 1.0)[0] == "#ffffff"
    assert colour(2.0, 2.0) == colour(9.0, 2.0) == ("#a33022", 1.0)
    assert colour(-2.0, 2.0) == ("#1b4f72", 1.0)
    assert colour(float("nan"), 1.0) == ("#f4f6f7", 0.0)


@pytest.mark.parametrize(
    ("value", "limit", "words"),
    [(0.974, 1.0, ".97"), (-0.5, 1.0, "−.50"), (1.0, 1.0, "1.00"), (-0.001, 1.0, ".00"), (12.34, 20.0, "12")],
)
def test_numbers_in_cells(value: float, limit: float, words: str) -> None:
    assert number(value, limit) == words


def test_all_cells_are_drawn_and_those_without_a_value_stay_empty() -> None:
    found = matrix(Matrix("m", NAMES, ("v", "r"), np.array([[1.0, 0.25], [np.nan, -0.75], [0.0, 0.5]])))
    keys = 5
    assert found.count("<rect") == 6 + keys and found.count('fill="#f4f6f7"') == 1
    for words in (*NAMES, "1.00", ".25", "−.75"):
        assert f">{words}</text>" in found
    assert "nan" not in found


def test_many_columns_are_drawn_without_numbers() -> None:
    names = tuple(f"c{k}" for k in range(30))
    found = matrix(Matrix("m", NAMES, names, np.full((3, 30), 0.25)))
    assert ">.25</text>" not in found and found.count("<rect") == 93


def test_the_limit_is_the_largest_value_where_none_is_given() -> None:
    assert full_colour(Matrix("m", ("a",), ("b", "c"), np.array([[3.0, -7.0]]), limit=None)) == 7.0
    assert full_colour(Matrix("m", ("a",), ("b",), np.array([[np.nan]]), limit=None)) == 1.0


def test_names_must_fit_the_values() -> None:
    with pytest.raises(InputError, match=r"shape \(2, 3\)"):
        Matrix("m", NAMES, ("v", "r"), np.zeros((2, 3)))


def test_correlations_are_the_lower_triangle() -> None:
    covariance = np.array([[4.0, -1.0, 0.0], [-1.0, 1.0, 0.3], [0.0, 0.3, 1.0]])
    found = heat_map(NAMES, covariance)
    assert re.findall(r">([−.\d]+)</text>", found) == ["−.50", ".00", ".30"] and found.count("<rect") == 3


def test_no_cells_no_picture() -> None:
    assert matrix(Matrix("m", (), (), np.empty((0, 0)))) == "" == heat_map(("a",), np.eye(1))
