"""Slopes of a spline against scipy's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from seatrial.numerics.kernels.spline import spline_points, spline_slopes


@pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
def test_slopes_are_those_of_the_not_a_knot_spline(count: int, rng: np.random.Generator) -> None:
    u, place = rng.standard_normal((count, 3)), np.arange(count)
    np.testing.assert_allclose(spline_slopes(u), CubicSpline(place, u)(place, 1), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
def test_points_are_those_of_the_not_a_knot_spline(count: int, rng: np.random.Generator) -> None:
    u, place = rng.standard_normal((count, 3)), np.linspace(0.0, count - 1.0, 97)
    value, rise = spline_points(u, spline_slopes(u), place)
    exact = CubicSpline(np.arange(count), u)
    np.testing.assert_allclose(value, exact(place), rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(rise, exact(place, 1), rtol=1e-10, atol=1e-12)


def test_one_sample_has_no_slope() -> None:
    np.testing.assert_array_equal(spline_slopes(np.ones((1, 2))), [[0.0, 0.0]])
    value, rise = spline_points(np.ones((1, 2)), np.zeros((1, 2)), np.zeros(3))
    np.testing.assert_array_equal(value, np.ones((3, 2)))
    np.testing.assert_array_equal(rise, np.zeros((3, 2)))


def test_what_comes_later_is_felt_by_the_stated_factor(rng: np.random.Generator) -> None:
    u = rng.standard_normal((30, 1))
    bent = u.copy()
    bent[20:] += 1.0
    felt = np.abs(spline_slopes(bent) - spline_slopes(u))[:, 0]
    np.testing.assert_allclose(felt[12:18] / felt[13:19], 2.0 - np.sqrt(3.0), rtol=1e-6)
