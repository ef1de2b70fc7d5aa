"""What a metre of wave does to a loop: strips summed by brute force, the long wave, and a panel code."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import G
from seatrial.physics.loops import HullFactor, WaveSlope, YawAcceleration

HULL = YawAcceleration(100.0, 4.0)


def moment_over_inertia(omega: Array, beta: float, strips: int = 20_001) -> Array:
    """Return the yaw acceleration of strips of equal mass, each with the water's acceleration, by trapezoids."""
    x = np.linspace(-0.5 * HULL.L, 0.5 * HULL.L, strips)
    k = omega[:, None] ** 2 / G
    lateral = omega[:, None] ** 2 * math.sin(beta) * np.exp(-0.5 * k * HULL.T) * np.exp(-1j * k * x * math.cos(beta))
    return np.trapezoid(x * lateral, x, axis=1) / np.trapezoid(x**2, x)


@pytest.mark.parametrize("heading", [20.0, 45.0, 120.0, 170.0])
def test_the_yaw_acceleration_is_the_sum_over_strips(heading: float) -> None:
    omega, beta = np.geomspace(0.2, 2.0, 30), math.radians(heading)
    np.testing.assert_allclose(HULL.amplitude(omega, 7.0, beta), moment_over_inertia(omega, beta), atol=2e-9)


def test_a_long_wave_turns_the_hull_as_it_turns_the_water() -> None:
    """The lateral orbital motion a sin(beta) turns by its slope along the ship, k cos(beta)."""
    omega = np.array([0.05])
    yaw = np.abs(HULL.amplitude(omega, 0.0, math.pi / 4.0)) / omega**2
    assert yaw == pytest.approx(0.5 * omega**2 / G, rel=1e-3)


def test_waves_along_and_across_the_ship_do_not_yaw_it() -> None:
    for heading in (0.0, 90.0, 180.0):
        assert not np.any(HULL.amplitude(np.array([0.5, 1.0]), 7.0, math.radians(heading)))


def test_the_slope_of_a_small_hull_is_that_of_a_point() -> None:
    omega = np.geomspace(0.2, 2.0, 10)
    point = HullFactor(1e-6, 1e-6, 1e-6)
    np.testing.assert_allclose(point.amplitude(omega, 5.0, 1.0), WaveSlope().amplitude(omega, 5.0, 1.0), rtol=1e-6)
    assert math.isinf(WaveSlope().frequency_range[1]) and HullFactor(1.0, 1.0, 2.0).frequency_range[1] < 10.0
