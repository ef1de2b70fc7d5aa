"""The spread of a motion, and when a simulation is further off than that."""

import math

import numpy as np
import pytest

from seatrial.core.results.prediction import HEADING_SPREAD, motion_spread, motion_spreads
from seatrial.core.values import Record

TIME = np.arange(1000) * 0.1
SWING = np.sin(2.0 * np.pi * TIME / 10.0)


def test_the_spread_is_the_standard_deviation_in_the_unit_of_the_error() -> None:
    spread = motion_spread("psi_deg", [math.radians(20.0) * SWING])
    assert spread == pytest.approx(20.0 / math.sqrt(2.0))
    assert motion_spread("position_m", [3.0 * SWING, 4.0 * SWING]) == pytest.approx(5.0 / math.sqrt(2.0))


def test_turns_on_and_on_spread_a_heading_no_further_than_all_directions_do() -> None:
    spread = motion_spread("psi_deg", [0.5 * TIME])
    assert spread == pytest.approx(math.degrees(HEADING_SPREAD)) == pytest.approx(103.92, 1e-4)


def test_a_held_heading_is_judged_as_a_small_turn_and_a_turn_by_itself() -> None:
    """1.4 and 7.1 deg by hand, a sine of 2 and 10 deg."""
    held, turned = (
        motion_spreads({"psi_deg": 1.0}, Record.from_arrays("run", TIME, {"psi": math.radians(size) * SWING}))[
            "psi_deg"
        ]
        for size in (2.0, 10.0)
    )
    assert held == pytest.approx(10.0)
    assert turned == pytest.approx(10.0 / math.sqrt(2.0))


def test_the_way_along_a_held_course_is_no_motion_to_measure_a_position_by() -> None:
    """A leg of 8 km: 75 m off are 0.032 of its standard deviation, and 0.19 of what 10 degrees lead to."""
    ahead, names = 81.2 * TIME, {"psi_deg": 1.0, "position_m": 75.0}
    still = np.zeros_like(TIME)
    leg, turned = (
        motion_spreads(names, Record.from_arrays("leg", TIME, {"x0": ahead, "y0": still, "psi": heading}))["position_m"]
        for heading in (still, math.radians(20.0) * SWING)
    )
    assert 75.0 / turned == pytest.approx(0.032, abs=5e-4)
    assert leg == pytest.approx(turned * math.sin(math.radians(10.0)))


def test_on_the_spot_a_place_spreads_as_far_as_the_hull_ends_swing() -> None:
    """A craft of 2 m that turns round and round: its ends move by 1 m; one that turns little, by that share of it."""
    names, wander = {"psi_deg": 1.0, "position_m": 0.44}, 0.3 * SWING
    spin, swing, unknown = (
        motion_spreads(names, Record.from_arrays("spin", TIME, {"x0": wander, "y0": 0.0 * wander, "psi": psi}), length)
        for psi, length in ((0.5 * TIME, 2.0), (0.4 * SWING, 2.0), (0.5 * TIME, 0.0))
    )
    assert spin["position_m"] == pytest.approx(1.0)
    assert swing["position_m"] == pytest.approx(0.4 / math.sqrt(2.0))
    assert unknown["position_m"] == pytest.approx(0.3 / math.sqrt(2.0))
    far = Record.from_arrays("circle", TIME, {"x0": 30.0 * SWING, "y0": 0.0 * SWING, "psi": 0.5 * TIME})
    assert motion_spreads(names, far, 2.0)["position_m"] == pytest.approx(30.0 / math.sqrt(2.0))
