"""Forces shared out: an inverse of B, the least effort, what is possible against closed forms."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.control.station.station_cases import azimuths, craft, cross_drive

from seatrial.control.station.craft import (
    capability,
    current_force,
    generalised_inverse,
    largest_force,
    refuse_under_actuated,
    share_given,
    thruster_orders,
    weights,
)
from seatrial.core.values import InputError
from seatrial.physics.models import model_named


def test_the_inverse_gives_the_force_with_the_least_effort() -> None:
    own, force = craft(cross_drive()), np.array([20.0, -7.0, 3.0])
    inverse, most = generalised_inverse(own), weights(own)
    assert own.configuration @ inverse == pytest.approx(np.eye(3), abs=1e-12)
    held = {"type": "eq", "fun": lambda T: own.configuration @ T - force}
    best = minimize(lambda T: float(np.sum((T / most) ** 2)), np.zeros(4), constraints=held, tol=1e-12)
    assert inverse @ force == pytest.approx(best.x, abs=1e-5)


def test_an_azimuth_has_a_row_ahead_and_one_to_starboard() -> None:
    """Four at (1.8, -0.8), ... of equal thrust: a quarter of the force each, a moment across the arm."""
    own = craft(azimuths())
    rows = [one.inverse for one in thruster_orders(own, generalised_inverse(own))]
    arm = 4.0 * (1.8**2 + 0.8**2)
    assert len(rows) == 4
    assert rows[0] == pytest.approx(np.array([[0.25, 0.0, 0.8 / arm], [0.0, 0.25, 1.8 / arm]]))
    assert rows[2] == pytest.approx(np.array([[0.25, 0.0, -0.8 / arm], [0.0, 0.25, -1.8 / arm]]))


def test_the_largest_force_is_that_of_the_geometry() -> None:
    """Four thrusters of 60 N ahead and 45 N astern at 45 degrees: 4 cos 45 60 ahead, 2 (60 + 45) cos 45 aside."""
    own = craft(cross_drive())
    (ahead, limiting), (astern, _), (aside, _) = (
        largest_force(own, np.array(one)) for one in ([1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0])
    )
    assert ahead == pytest.approx(4.0 * 60.0 * math.sqrt(0.5))
    assert astern == pytest.approx(4.0 * 45.0 * math.sqrt(0.5))
    # held without moment by pairs on a diagonal: all at the weaker side's thrust
    assert aside == pytest.approx(4.0 * 45.0 * math.sqrt(0.5))
    assert len(limiting) == 4


def test_azimuths_give_all_their_thrust_anywhere() -> None:
    own = craft(azimuths())
    for angle in (0.0, 0.3, 1.1):
        force = np.array([math.cos(angle), math.sin(angle), 0.0])
        assert largest_force(own, force)[0] == pytest.approx(4.0 * own.tables[0].most, rel=0.01)
        assert share_given(own, generalised_inverse(own), force[None])[0] == pytest.approx(4.0 * own.tables[0].most)


def test_the_current_that_is_held_from_ahead_is_that_of_the_drag() -> None:
    """8 V + 30 V^2 = 4 cos 45 60 N; from port as from starboard."""
    own = craft(cross_drive())
    holds = capability(own, generalised_inverse(own))
    V = (-8.0 + math.sqrt(64.0 + 4.0 * 30.0 * 240.0 * math.sqrt(0.5))) / 60.0
    assert holds.current[0] == pytest.approx(V, rel=1e-4)
    assert holds.current_shared_out[0] == pytest.approx(V, rel=1e-4)
    assert holds.current[1:] == pytest.approx(holds.current[:0:-1], rel=1e-3)
    assert np.all(holds.current_shared_out <= holds.current * (1.0 + 1e-3))
    force = current_force(own, float(holds.current[5]), float(holds.direction[5]))
    assert largest_force(own, -force)[0] == pytest.approx(1.0, rel=1e-3)


def test_a_craft_without_side_force_keeps_no_station() -> None:
    with pytest.raises(InputError, match=r"give no sway of their own.*leave \[station\] out, or add one"):
        refuse_under_actuated(craft(model_named("thrusters")))
    refuse_under_actuated(craft(azimuths()))
