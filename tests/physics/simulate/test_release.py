"""A ship released from an angle: as the closed form and another integrator have it, to the right side."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.models import nomoto, roll
from seatrial.physics.simulate.steer import natural_period, release

OMEGA, ZETA = 0.85, 0.03


def ship(**values: float) -> Model:
    linear = {"b_1": 2.0 * ZETA * OMEGA, "b_2": 0.0, "b_3": 0.0, "c_1": OMEGA**2, "c_3": 0.0, "c_5": 0.0, "phi_0": 0.0}
    return roll().with_values(linear | values)


def test_a_linear_decay_has_the_measures_of_the_closed_form() -> None:
    model = ship()
    seen = measures(release(model, "release:15", natural_period(model)), 36.0)
    damped = OMEGA * math.sqrt(1.0 - ZETA**2)  # phi' = 0 every half damped period, each smaller by exp(-zeta w T_d / 2)
    halving = math.exp(-ZETA * OMEGA * math.pi / damped)
    assert seen["swing_1_deg"] == pytest.approx(15.0 * halving, rel=1e-4)
    assert seen["swing_2_deg"] == pytest.approx(15.0 * halving**2, rel=1e-4)
    assert seen["period_s"] == pytest.approx(2.0 * math.pi / damped, rel=1e-4)
    assert seen["half_time_s"] == pytest.approx(math.log(2.0) / (ZETA * OMEGA), rel=1e-3)


def test_a_nonlinear_decay_is_that_of_another_integrator() -> None:
    model = ship(b_2=0.4, c_3=0.5)
    record = release(model, "release:25:port", natural_period(model), 40.0)

    def rates(_t: float, x: np.ndarray) -> list[float]:
        phi, p = x
        return [p, -2.0 * ZETA * OMEGA * p - 0.4 * p * abs(p) - OMEGA**2 * phi - 0.5 * phi**3]

    start = [-math.radians(25.0), 0.0]
    other = solve_ivp(rates, (0.0, 41.0), start, t_eval=record.time, rtol=1e-10, atol=1e-12)
    assert record["phi"] == pytest.approx(other.y[0], abs=1e-6)


def test_the_angle_counts_from_the_angle_of_rest() -> None:
    model = ship(phi_0=0.02)
    record = release(model, "release:10", natural_period(model))
    assert record["phi"][0] == pytest.approx(math.radians(10.0) + 0.02)


def test_which_models_roll_only() -> None:
    assert ship().is_roll
    assert not nomoto().is_roll


def test_a_ship_that_does_not_right_itself_cannot_be_released() -> None:
    with pytest.raises(InputError, match="positive restoring"):
        natural_period(ship(c_1=-0.1))
    with pytest.raises(InputError, match="duration"):
        release(ship(), "release:10", 7.0, -1.0)
