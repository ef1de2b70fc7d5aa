"""Intervals of measures: within what the measure can be, and symmetric where they are narrow."""

import math

import pytest

from seatrial.physics.manoeuvres import bounded_interval


@pytest.mark.parametrize(
    ("name", "value", "half", "lowest", "highest"),
    [
        ("tactical_diameter_L", 3.0, 4.0, 0.0, math.inf),
        ("overshoot_1_deg", 1.3, 2.0, 0.0, math.inf),
        ("time_90_s", 40.0, 50.0, 0.0, math.inf),
        ("speed_loss", 0.6, 0.6, -math.inf, 1.0),
        ("steady_drift_deg", 20.0, 100.0, -90.0, 90.0),
    ],
)
def test_wide_intervals_stay_among_possible_values(
    name: str, value: float, half: float, lowest: float, highest: float
) -> None:
    bounds = bounded_interval(name, value, half)
    assert bounds is not None
    assert lowest < bounds[0] < value < bounds[1] < highest


@pytest.mark.parametrize("name", ["advance_L", "overshoot_2_deg", "speed_loss", "steady_drift_deg", "transfer_L"])
def test_narrow_intervals_are_symmetric(name: str) -> None:
    bounds = bounded_interval(name, 0.7, 1e-4)
    assert bounds == pytest.approx((0.6999, 0.7001), abs=1e-7)


def test_the_interval_of_a_positive_measure_is_that_of_its_logarithm() -> None:
    assert bounded_interval("advance_L", 2.0, 1.0) == pytest.approx((2.0 / math.exp(0.5), 2.0 * math.exp(0.5)))


@pytest.mark.parametrize(
    ("name", "value", "half"),
    [("steady_drift_deg", 20.0, 169.0), ("tactical_diameter_L", 3.0, 9.0), ("overshoot_1_deg", -0.5, 0.1),
     ("speed_loss", 0.9, 0.4), ("steady_drift_deg", 95.0, 1.0), ("advance_L", 3.0, math.nan)],
)  # fmt: skip
def test_what_would_say_nothing_is_not_determined(name: str, value: float, half: float) -> None:
    assert bounded_interval(name, value, half) is None


def test_a_measure_without_limits_keeps_its_symmetric_interval() -> None:
    assert bounded_interval("residual_yaw_rate_deg_s", 0.1, 0.5) == (-0.4, 0.6)
