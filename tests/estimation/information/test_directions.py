"""Directions of the information in words, against matrices whose answer is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from seatrial.estimation.information.covariance import (
    collinearity,
    condition_number,
    directions,
    effective_parameters,
    relative_information,
)

NAMES = ("a", "b", "c")


def rotated(deviations: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Information with the given standard deviations along random axes, and the axes as columns."""
    axes = np.linalg.qr(rng.standard_normal((len(deviations), len(deviations))))[0]
    return (axes / deviations**2) @ axes.T, axes


def test_directions_come_weakest_first_with_their_deviations(rng: np.random.Generator) -> None:
    deviations = np.array([2.0, 0.05, 0.001])
    information, axes = rotated(deviations, rng)
    found = directions(information, NAMES, np.ones(3))
    np.testing.assert_allclose([d.standard_deviation for d in found], deviations, rtol=1e-6)
    for direction, axis in zip(found, axes.T, strict=True):
        vector = np.array([direction.combination[n] for n in NAMES])
        assert abs(vector @ axis) == pytest.approx(1.0, abs=1e-6)
        assert list(map(abs, direction.combination.values())) == sorted(map(abs, vector), reverse=True)


def test_sizes_make_changes_relative_with_the_sign_of_the_value() -> None:
    """Known: a to .1 of its 10, b to .2 of its -2: 1 % and 10 % of them."""
    information = np.diag([1 / 0.1**2, 1 / 0.2**2])
    weakest, strongest = directions(information, ("a", "b"), np.array([10.0, -2.0]))
    assert weakest.standard_deviation == pytest.approx(0.1)
    assert weakest.text == "b is determined to 10 %"
    assert strongest.text == "a is determined to 1 %"


@pytest.mark.parametrize(
    ("deviation", "says"),
    [(0.02, "is determined to 2 %"), (0.5, "leave 50 % open"), (3.0, "determine nothing"), (np.inf, "any amount")],
)
def test_words_say_how_well_a_combination_is_known(deviation: float, says: str) -> None:
    axis = np.array([0.8, -0.6])
    across = np.array([0.6, 0.8])
    weight = 0.0 if np.isinf(deviation) else deviation**-2
    information = weight * np.outer(axis, axis) + 1e6 * np.outer(across, across)
    text = directions(information, ("a", "b"), np.ones(2))[0].text
    assert "+0.80 a -0.60 b" in text and says in text


def test_words_say_what_a_prior_leaves_of_an_open_direction() -> None:
    """Two directions the records leave open; a prior of 3 % holds one of them."""
    information = np.diag([1.0, 0.25, 1e6])
    weakest, next_one, third = directions(information, NAMES, np.ones(3), np.diag([0.03**-2, 0.0, 0.01**-2]))
    assert weakest.text == "b is not determined: it may be wrong by 200 %"
    assert next_one.text == ("a is determined vaguely, to 100 %; what is known besides the records holds it to 3 %")
    assert third.text == "c is determined to 0.1 %"
    assert weakest.standard_deviation == pytest.approx(2.0), "of the records alone"


def test_effective_parameters_count_what_data_tell_against_a_prior() -> None:
    information, precision = np.diag([99.0, 1.0, 0.0]), np.diag([1.0, 1.0, 1.0])
    along = directions(information, NAMES, np.ones(3))
    assert effective_parameters(information, precision, along) == pytest.approx(0.99 + 0.5)
    assert effective_parameters(information, np.zeros((3, 3)), along) == 1.0


def test_a_combination_is_no_better_known_than_the_intervals_have_it() -> None:
    """Runs left out scatter by 200 % along a: model error that the information does not know of."""
    information = np.diag([0.01**-2, 0.02**-2, 0.05**-2])
    weakest, *_ = directions(information, NAMES, np.ones(3), covariance=np.diag([4.0, 1e-6, 1e-6]))
    assert weakest.text == "a is not determined: it may be wrong by 200 %"
    along = directions(information, NAMES, np.ones(3), covariance=np.diag([4.0, 1e-6, 1e-6]))
    assert [d.standard_deviation for d in along] == pytest.approx([2.0, 0.05, 0.02])
    assert effective_parameters(information, np.zeros((3, 3)), along) == 2.0


@given(arrays(float, 3, elements=st.floats(0.01, 100.0)))
def test_variance_inflation_and_condition_know_no_units(sizes: np.ndarray) -> None:
    information = np.array([[4.0, 1.9, 0.1], [1.9, 1.0, 0.0], [0.1, 0.0, 9.0]])
    here, there = (collinearity(m, NAMES) for m in (information, relative_information(information, sizes)))
    for one, other in zip(here, there, strict=True):
        assert one.partner == other.partner
        assert one.variance_inflation == pytest.approx(other.variance_inflation, rel=1e-6)
    assert condition_number(relative_information(information, sizes)) == pytest.approx(
        condition_number(information), rel=1e-6
    )


def test_two_almost_equal_columns_are_each_other_s_partners(rng: np.random.Generator) -> None:
    """VIF = 1 / (1 - R^2) of the regression of one column on the others."""
    matrix = rng.standard_normal((400, 3))
    matrix[:, 1] = matrix[:, 0] + 0.1 * matrix[:, 1]
    found = collinearity(matrix.T @ matrix, NAMES)
    others = matrix[:, [1, 2]]
    left = matrix[:, 0] - others @ np.linalg.lstsq(others, matrix[:, 0])[0]
    assert found[0].variance_inflation == pytest.approx(matrix[:, 0] @ matrix[:, 0] / (left @ left), rel=1e-6)
    assert (found[0].partner, found[1].partner) == ("b", "a")
    assert found[0].correlation < -0.9
    assert found[2].variance_inflation < 1.1


def test_a_missing_direction_has_infinite_condition() -> None:
    assert condition_number(np.ones((2, 2))) == np.inf
