"""Two screws and rudders, two nozzles with buckets: equal sides are one, shafts against each other turn the ship."""

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models import model_named
from seatrial.physics.models.mmg import mmg, mmg_twin
from seatrial.physics.models.published import kvlcc2_l7
from seatrial.physics.models.waterjet import waterjet, waterjet_twin
from seatrial.problems.twin_ships import twin_screw_ship


def forces(model: Model, states: dict[str, float], **inputs: float) -> dict[str, float]:
    """Bindings at one state; what is not named is zero."""
    x = np.array([[states.get(name, 0.0) for name in model.states]])
    u = np.array([[inputs.get(name, 0.0) for name in model.input_names]])
    return {name: float(values[0]) for name, values in model.forces(x, u).items()}


def tanker(model: Model, **values: float) -> Model:
    """KVLCC2 with one set of coefficients for either side of the flow."""
    published = kvlcc2_l7()
    known = {**published.values, **published.ship.particulars, "C_2_minus": 1.6, "gamma_R_minus": 0.640, **values}
    return model.with_values({name: value for name, value in known.items() if name in model.parameters})


@pytest.mark.parametrize("u", [1.2, 0.3, -0.5])
@pytest.mark.parametrize("n", [10.0, -6.0])
def test_two_equal_screws_on_the_centre_line_are_twice_one(u: float, n: float) -> None:
    area = tanker(mmg()).parameters["A_R"].value
    motion, orders = {"u": u, "v": -0.2, "r": 0.05}, {"delta": 0.3, "n": n}
    one = forces(tanker(mmg()), motion, **orders)
    two = forces(tanker(mmg_twin(), A_R=area / 2, y_P=0.0), motion, **orders)
    for name, times in (("thrust", 2), ("X_P", 2), ("X_R", 1), ("Y_R", 1), ("N_R", 1), ("X_H", 1), ("Y_H", 1)):
        assert two[name] == pytest.approx(times * one[name], rel=1e-12), name


def test_shafts_against_each_other_turn_on_the_spot_to_the_side_of_the_shaft_astern() -> None:
    ship = twin_screw_ship()
    found = forces(ship, {}, n_difference=20.0)
    k_0, k_0_astern = ship.parameters["k_0"].value, ship.parameters["k_0_astern"].value
    D, rho, t, y = (ship.parameters[name].value for name in ("D_P", "rho", "t_P", "y_P"))
    ahead, astern = rho * D**4 * 100.0 * k_0, rho * D**4 * 100.0 * k_0_astern
    assert found["X_P"] == pytest.approx((1 - t) * (ahead + astern), rel=1e-9)
    assert found["N_P"] == pytest.approx(y * (1 - t) * (ahead - astern), rel=1e-9)
    assert found["N_P"] > 0.0  # port ahead, starboard astern: to starboard


def test_rudders_apart_brake_and_do_not_turn() -> None:
    ship = twin_screw_ship().with_values({"gamma_R_plus": 0.4, "gamma_R_minus": 0.4})
    found = forces(ship, {"u": 1.5}, n=10.0, delta_difference=0.6)
    assert found["Y_R"] == pytest.approx(0.0, abs=1e-9)
    assert found["N_R"] == pytest.approx(0.0, abs=1e-9)
    assert found["X_R"] < 0.0


def test_a_turning_ship_loads_the_screw_on_the_inside() -> None:
    found = forces(twin_screw_ship().with_values({"C_1": 0.0}), {"u": 1.5, "r": 0.2}, n=10.0)
    assert found["thrust_starboard"] > found["thrust_port"]  # a turn to starboard: it meets slower water


MOTION = {"u": 3.0, "v": -0.4, "r": 0.1}


def test_two_equal_nozzles_with_buckets_up_are_one() -> None:
    one, two = forces(waterjet(), MOTION, delta=0.2, v_j=9.0), forces(waterjet_twin(), MOTION, delta=0.2, v_j=9.0)
    for name in ("X_sum", "Y_sum", "N_sum"):
        assert two[name] == pytest.approx(one[name], rel=1e-12)


def test_a_full_bucket_leaves_the_momentum_that_enters_and_the_part_that_is_turned() -> None:
    craft = waterjet_twin()
    rho, A_j, c_b = (craft.parameters[name].value for name in ("rho", "A_j", "c_b"))
    found = forces(craft, {"u": 3.0}, v_j=9.0, bucket=1.0)
    assert found["X_P"] == pytest.approx(-2 * rho * A_j * 9.0 * (3.0 + c_b * 9.0), rel=1e-12)


def test_one_bucket_down_turns_to_its_side() -> None:
    found = forces(waterjet_twin(), {}, v_j=9.0, bucket=0.5, bucket_difference=1.0)
    assert found["N_P"] < 0.0  # port bucket down: to port
    assert found["Y_P"] == 0.0


def straight(name: str) -> Array:
    """Lateral rates of a craft whose shafts or jets are equal, straight ahead."""
    model = twin_screw_ship() if name == "mmg_twin" else model_named(name)
    x = np.array([1.5 if state == "u" else 0.0 for state in model.states])
    u = np.array([9.0 if i in ("n", "v_j") else 0.3 if i == "delta_difference" else 0.0 for i in model.input_names])
    rates = np.empty(len(x))
    model.compiled.rates(0.0, x, u, model.parameters.values, rates)
    return rates[[model.states.index(state) for state in ("v", "r")]]


@pytest.mark.parametrize("name", ["mmg_twin", "waterjet_twin"])
def test_equal_sides_go_straight(name: str) -> None:
    np.testing.assert_allclose(straight(name), 0.0, atol=1e-12)
