"""Orders shared out over thrusters: who works for what, and the same motion as with the commands themselves."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.models import model_named
from seatrial.physics.models.thrust_orders import AHEAD, YAW, WorkShare, with_orders, work_shares
from seatrial.physics.models.thruster_layout import CATAMARAN, AngleInput, CommandInput, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters


def test_each_thruster_works_to_the_side_to_which_it_drives_and_turns() -> None:
    layout = ThrusterLayout((
        Thruster("port", -0.5, -0.3, CommandInput("command_1")),
        Thruster("starboard_astern", -0.5, 0.3, CommandInput("command_2"), angle=math.pi),
        Thruster("tunnel", 0.4, 0.0, CommandInput("command_3"), angle=math.pi / 2),
        Thruster("middle", -0.5, 0.0, CommandInput("command_4"), angle=AngleInput("alpha_1")),
    ))  # fmt: skip
    assert work_shares(layout) == (WorkShare(1, 1), WorkShare(-1, 1), WorkShare(0, 1), WorkShare(1, 0))


def test_orders_move_the_craft_as_the_commands_that_they_stand_for() -> None:
    model = model_named("thrusters")
    ordered = with_orders(model)
    assert ordered.input_names == (AHEAD, YAW) and ordered.states == model.states
    state = np.array([0.8, 0.1, 0.2, 0.3, 0.0, 0.0, 0.4, -0.2])
    by_command, by_order = np.empty(8), np.empty(8)
    model.compiled.rates(0.0, state, np.array([0.7, 0.3]), model.parameters.values, by_command)
    ordered.compiled.rates(0.0, state, np.array([0.5, 0.2]), model.parameters.values, by_order)
    assert np.allclose(by_order, by_command, rtol=1e-12, atol=0.0)


def test_a_craft_with_its_sides_exchanged_turns_by_the_same_orders() -> None:
    """Places are parameters: the equations with commands are the same, those with orders are not."""
    port, starboard = CATAMARAN.thrusters
    exchanged = ThrusterLayout((replace(port, y=starboard.y), replace(starboard, y=port.y)))
    state, row = np.zeros(8), np.array([0.0, 1.0])
    state[6:] = 0.5
    for layout in (CATAMARAN, exchanged):
        ordered, rates = with_orders(thrusters(layout)), np.empty(8)
        ordered.compiled.rates(0.0, state, row, ordered.parameters.values, rates)
        assert np.sign(rates[6:]).tolist() == [-np.sign(t.y) for t in layout.thrusters]  # port ahead


def test_azimuth_thrusters_amidships_point_ahead() -> None:
    thruster = Thruster("pod", 0.0, 0.3, CommandInput("command_1"), angle=AngleInput("alpha_1"), lag=0.0)
    ordered = with_orders(thrusters(ThrusterLayout((thruster, replace(thruster, name="other", y=-0.3)))))
    assert ordered.input_names == (AHEAD, YAW)


def test_a_model_without_thrusters_takes_no_orders() -> None:
    with pytest.raises(InputError, match="has no thrusters"):
        with_orders(model_named("waterjet"))
