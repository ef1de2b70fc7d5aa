"""Closed forms of roll against the motion itself."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from seatrial.core.values import Array
from seatrial.physics.hydro.free_roll import (
    equivalent_damping,
    gyradius_of,
    metacentric_height,
    observed_swings,
    swing_period,
)


def motion(b: Array, c: Array, start: float, time: Array) -> Array:
    """Roll angle by an integrator that is none of the house's."""

    def rates(_: float, x: Array) -> list[float]:
        phi, p = x
        damping = b[0] * p + b[1] * p * abs(p) + b[2] * p**3
        return [p, -damping - c[0] * phi - c[1] * phi**3 - c[2] * phi**5]

    return solve_ivp(rates, (0.0, time[-1]), [start, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0]


@settings(max_examples=8, deadline=None)
@given(c_1=st.floats(0.2, 20.0), hard=st.floats(-0.5, 3.0), fifth=st.floats(-0.2, 3.0), amplitude=st.floats(0.01, 0.6))
def test_an_undamped_swing_lasts_its_period(c_1: float, hard: float, fifth: float, amplitude: float) -> None:
    """After a period it stands where it began."""
    c = c_1 * np.array([1.0, hard, fifth])
    period = swing_period(c, np.array([amplitude]))[0][0]
    quarters = motion(np.zeros(3), c, amplitude, period * np.array([0.0, 0.25, 0.5, 1.0]))
    np.testing.assert_allclose(quarters, amplitude * np.array([1.0, 0.0, -1.0, 1.0]), atol=1e-6 * amplitude)


def test_small_swings_last_two_pi_over_root_c_1_and_derivatives_are_differences() -> None:
    """Period and equivalent damping."""
    b, c, amplitude = np.array([0.03, 0.2, 0.4]), np.array([6.0, 4.0, -30.0]), np.array([1e-6, 0.1, 0.25])
    assert swing_period(c, amplitude)[0][0] == pytest.approx(2.0 * np.pi / np.sqrt(6.0), rel=1e-9)
    for k in range(6):
        step = 1e-6 * np.eye(6)[k]
        ahead, behind = (
            equivalent_damping(b + s * step[:3], c + s * step[3:], amplitude)[0] for s in (1.0, -1.0)
        )  # fmt: skip
        slope = equivalent_damping(b, c, amplitude)[1][:, k]
        np.testing.assert_allclose(slope, (ahead - behind) / 2e-6, rtol=1e-5, atol=1e-9)


def test_equivalent_damping_takes_the_same_energy() -> None:
    """A harmonic swing: int damping p dt over a period is pi w a^2 b_e."""
    b, c, a = np.array([0.05, 0.3, 0.2]), np.array([2.0, 0.0, 0.0]), 0.3
    omega = np.sqrt(2.0)
    p = omega * a * np.cos(2.0 * np.pi * (np.arange(4000) + 0.5) / 4000)
    work = np.mean((b[0] * p + b[1] * p * np.abs(p) + b[2] * p**3) * p) * 2.0 * np.pi / omega
    assert equivalent_damping(b, c, np.array([a]))[0][0] == pytest.approx(work / (np.pi * omega * a**2), rel=1e-6)


def test_a_swing_that_does_not_come_back_has_no_period() -> None:
    """Beyond the angle of vanishing restoring."""
    period = swing_period(np.array([1.0, -4.0, 0.0]), np.array([0.2, 0.6]))[0]
    assert np.isfinite(period[0])
    assert np.isnan(period[1])


def test_recorded_swings_show_damping_and_period() -> None:
    """A damped decay, read without any model: within 1 % of the damping, a thousandth of the period."""
    b, c = np.array([0.04, 0.25, 0.0]), np.array([6.0, 3.0, 0.0])
    amplitude, damping, period = observed_swings(motion(b, c, 0.25, np.arange(0.0, 60.0, 0.05)), 0.05)
    assert len(amplitude) > 40
    np.testing.assert_allclose(damping, equivalent_damping(b, c, amplitude)[0], rtol=0.03)
    assert np.mean(damping / equivalent_damping(b, c, amplitude)[0]) == pytest.approx(1.0, abs=0.01)
    np.testing.assert_allclose(period, swing_period(c, amplitude)[0], rtol=2e-3)
    assert all(len(part) == 0 for part in observed_swings(np.linspace(0.1, 0.0, 50), 0.05))


def test_metacentric_height_is_that_of_the_natural_period() -> None:
    """T = 2 pi k / sqrt(g GM)."""
    height = metacentric_height((2.0 * np.pi / 10.0) ** 2, 8.0)
    assert 2.0 * np.pi * 8.0 / np.sqrt(9.80665 * height) == pytest.approx(10.0, rel=1e-3)
    assert gyradius_of((2.0 * np.pi / 10.0) ** 2, height) == pytest.approx(8.0)
