"""Steps in a sample: one where it is enough, more where the craft is faster than its samples."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.core.values import Array
from seatrial.physics.models import model_named
from seatrial.physics.simulate import trajectory
from seatrial.physics.simulate.batch import MOST_SUBSTEPS, error_over_range, sufficient_substeps
from seatrial.physics.simulate.states import actuator_motion

ROLL = {"b_1": 0.04, "b_2": 0.25, "c_1": (2.0 * math.pi / 5.0) ** 2, "phi_0": 0.0}  # a period of 5 s
RELEASE = np.array([math.radians(15.0), 0.0])


def rolled(dt: float, substeps: int | None = None) -> Array:
    return trajectory(
        model_named("roll").with_values(ROLL), np.zeros((round(90.0 / dt) + 1, 2)), dt, RELEASE, substeps
    )[0]


def test_a_roll_sampled_once_a_second_is_that_of_another_integrator() -> None:
    def rates(_: float, x: Array) -> list[float]:
        return [x[1], -ROLL["b_1"] * x[1] - ROLL["b_2"] * x[1] * abs(x[1]) - ROLL["c_1"] * x[0]]

    exact = solve_ivp(rates, (0.0, 90.0), RELEASE, t_eval=np.arange(91.0), rtol=1e-10, atol=1e-12).y.T
    error = np.max(np.abs(rolled(1.0) - exact), axis=0) / np.ptp(exact, axis=0)
    assert np.all(error < 1e-4)
    assert np.max(np.abs(rolled(1.0, substeps=1) - exact)[:, 0]) > 0.05 * RELEASE[0], "one step is not enough"


def test_where_one_step_is_enough_one_is_taken() -> None:
    np.testing.assert_array_equal(rolled(0.1), rolled(0.1, substeps=1))


def test_a_lag_of_a_twentieth_of_a_sample_is_followed() -> None:
    """One step of the classical scheme diverges beyond 2.8 lags."""
    model = model_named("thrusters").with_values({"tau": 0.05, "tau_down": 0.05})
    orders = np.repeat([[0.0, 0.0], [0.5, -0.5]], 10, axis=0)
    motion = actuator_motion(model, orders, 1.0)
    assert motion["c_port"][-1] == pytest.approx(0.5, abs=1e-6)


def test_a_model_that_diverges_by_itself_keeps_its_steps() -> None:
    counts = list[int]()

    def simulate(count: int) -> Array:
        counts.append(count)
        return np.array([[0.0], [1.0 / count], [np.nan]])

    assert sufficient_substeps(simulate, error_over_range) == 1
    assert max(counts) == MOST_SUBSTEPS


def test_steps_are_doubled_until_nothing_moves() -> None:
    assert sufficient_substeps(lambda n: np.array([[0.0], [1.0 + n**-4.0]]), error_over_range) == 16


def test_more_steps_are_for_nothing_where_any_difference_grows() -> None:
    """The position of an unstable craft after minutes: each number of steps ends elsewhere."""
    assert sufficient_substeps(lambda n: np.array([[0.0], [float(np.sin(n**2.0))]]), error_over_range) <= 4
