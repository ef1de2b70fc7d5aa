"""The steering angle of a craft: which thrusters and rudders steer, to which side, and the order in a record."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.physics.models.thrust_orders import AHEAD, YAW, with_orders
from seatrial.physics.models.thruster_layout import (
    CATAMARAN,
    ORDER,
    AngleInput,
    CommandInput,
    Rudder,
    ThrustCurve,
    Thruster,
    ThrusterLayout,
    order_text,
    steering_angles,
    with_steering_order,
)
from seatrial.physics.models.thrusters import thrusters


def pod(k: int, x: float, channel: str = "") -> Thruster:
    angle = AngleInput(channel or f"alpha_{k}")
    return Thruster(f"pod_{k}", x, 0.1 * k, CommandInput(f"command_{k}"), angle=angle, lag=0.0)


def test_thrust_astern_turns_to_the_other_side_and_amidships_to_none() -> None:
    layout = ThrusterLayout((pod(1, 2.0), pod(2, 0.0), pod(3, -2.0)))
    assert steering_angles(layout) == {"alpha_1": 1.0, "alpha_3": -1.0}
    assert order_text(layout) == "alpha_1 = delta, alpha_3 = -delta"
    assert steering_angles(CATAMARAN) == {} and steering_angles(ThrusterLayout((pod(1, 0.0),))) == {}


def test_two_outboards_on_one_bar_are_one_angle_and_rudders_are_positive_to_starboard() -> None:
    assert steering_angles(ThrusterLayout((pod(1, -2.0), pod(2, -2.0, "alpha_1")))) == {"alpha_1": -1.0}
    screw = Thruster(
        "screw", -2.0, 0.0, CommandInput("rpm_1"), curve=ThrustCurve.OPEN_WATER, diameter=0.3,
        rudder=Rudder("delta", -2.2, 0.05, 0.3),
    )  # fmt: skip
    assert steering_angles(ThrusterLayout((screw,))) == {"delta": 1.0}
    assert order_text(ThrusterLayout((screw,))) == ""


@pytest.mark.parametrize(("positive", "sign"), [("starboard", -1.0), ("port", 1.0)])
def test_the_order_in_a_record_is_positive_to_starboard(positive: str, sign: float) -> None:
    time, layout = np.arange(5.0), ThrusterLayout((pod(1, -2.0),))
    record = Record.from_arrays("run", time, {"alpha_1": 0.1 * time})
    record = record.with_channel("alpha_1", replace(record.channel("alpha_1"), positive=positive))
    np.testing.assert_allclose(with_steering_order(record, layout)[ORDER], sign * 0.1 * time)
    assert with_steering_order(record, CATAMARAN) is record
    turning = Record.from_arrays("azimuth", time, {"alpha_1": time})
    assert with_steering_order(turning, layout) is turning, "thrust ahead and astern is no steering"
    assert with_steering_order(record.without("alpha_1"), layout).channels.keys() == set()


def test_an_order_of_the_angle_moves_the_craft_as_its_angles_do() -> None:
    model = thrusters(ThrusterLayout((pod(1, 2.0), pod(2, -2.0))))
    ordered = with_orders(model)
    assert ordered.input_names == (AHEAD, YAW, ORDER)
    state, by_angle, by_order = np.array([0.8, 0.1, 0.2, 0.3, 0.0, 0.0]), np.empty(6), np.empty(6)
    inputs = dict(zip(("command_1", "command_2", "alpha_1", "alpha_2"), (0.6, 0.6, 0.25, -0.25), strict=True))
    row = np.array([inputs[name] for name in model.input_names])
    model.compiled.rates(0.0, state, row, model.parameters.values, by_angle)
    ordered.compiled.rates(0.0, state, np.array([0.6, 0.0, 0.25]), model.parameters.values, by_order)
    np.testing.assert_allclose(by_order, by_angle, rtol=1e-12)
