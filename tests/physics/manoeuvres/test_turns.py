"""Turns at the craft's own time scale, whatever waves and compass add to the heading."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import Array
from seatrial.physics.manoeuvres.turns import course_of, reversals

STEP = 0.2  # s


def heading(orders: list[tuple[float, float]], T: float = 6.0, seconds: float = 900.0) -> Array:
    """Return the heading [rad] that follows courses ordered at times [s, deg] with a lag, (n,)."""
    time = STEP * np.arange(round(seconds / STEP))
    return np.radians(sum(angle * (1.0 - np.exp(-np.maximum(time - at, 0.0) / T)) for at, angle in orders) + 0.0 * time)


def in_waves(psi: Array, degrees: float = 0.4) -> Array:
    time = STEP * np.arange(len(psi))
    return psi + np.radians(degrees) * (np.sin(0.8 * time) + np.sin(0.97 * time + 1.0))


def whole_degrees(psi: Array) -> Array:
    return np.radians(np.round(np.degrees(psi)))


@pytest.mark.parametrize("measure", [np.array, in_waves, whole_degrees, lambda psi: whole_degrees(in_waves(psi))])
def test_waves_and_whole_degrees_hide_no_turn(measure: Callable[[Array], Array]) -> None:
    orders = [(100.0, 20.0), (250.0, 15.0), (400.0, -43.0), (600.0, 30.0)]
    course = course_of(measure(heading(orders)))
    angles = [float(np.degrees(turn.angle)) for turn in course.turns]
    assert angles == pytest.approx([20.0, 15.0, -43.0, 30.0], abs=1.5)
    for turn, (at, _) in zip(course.turns, orders, strict=True):
        assert STEP * turn.first == pytest.approx(at, abs=3.0)
    assert len(course.steady) == len(orders) + 1


def test_the_time_scale_is_that_of_the_quickest_turn() -> None:
    psi = heading([(100.0, 30.0)])
    course = course_of(psi)
    lag = course.scale
    assert float(np.max(np.abs(psi[lag:] - psi[:-lag]))) == pytest.approx(np.radians(8.0), rel=0.2)
    assert course_of(psi[::5]).scale == pytest.approx(lag / 5, abs=1.0)
    assert course_of(heading([(100.0, 30.0)], T=12.0)).scale == pytest.approx(2 * lag, rel=0.2)


def test_a_log_of_small_changes_is_judged_by_its_own_size() -> None:
    orders = [(100.0 + 120.0 * k, 7.0 * (-1) ** k) for k in range(6)]
    assert [turn.side for turn in course_of(heading(orders)).turns] == ["starboard", "port"] * 3


def test_what_hardly_turns_is_one_steady_course() -> None:
    psi = in_waves(np.zeros(2000))
    assert (course_of(psi).turns, course_of(psi).steady) == ((), ((0, 2000),))
    assert course_of(np.zeros(1)).steady == ((0, 1),)


@given(swings=st.lists(st.floats(2.5, 9.0), min_size=3, max_size=12), up=st.booleans())
def test_reversals_are_the_corners_of_a_zigzag(swings: list[float], up: bool) -> None:
    signs = (1.0 if up else -1.0) * (-1.0) ** np.arange(len(swings))
    corners = np.concatenate([[0.0], np.cumsum(signs * np.array(swings))])
    fine = np.interp(np.arange(10 * len(swings) + 1) / 10.0, np.arange(len(corners)), corners)
    ripple = 0.4 * np.where(np.arange(len(fine)) % 2 == 1, 1.0, 0.0)
    np.testing.assert_array_equal(reversals(fine, 2.0)[2:-2], 10 * np.arange(1, len(swings)))
    assert len(reversals(fine + ripple, 2.0)[2:-2]) == len(swings) - 1
