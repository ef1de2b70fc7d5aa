"""Craft with thrusters identified: what the commands cannot tell apart is refused by name, and what never moves."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.estimation.estimate.fit import refuse_without_excitation
from seatrial.estimation.information.symmetries import refuse_unidentifiable, structural_symmetries
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_layout import CommandInput, Damping, ThrustCurve, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters

OUTPUTS = ("u", "v", "r", "psi", "x0", "y0")


def test_two_thrusters_on_one_command_at_one_place_are_refused_with_their_coefficients() -> None:
    first = Thruster("one", -0.5, 0.0, CommandInput("command_1"), curve=ThrustCurve.LINEAR, lag=0.0)
    second = Thruster("two", -0.5, 0.0, CommandInput("command_1"), curve=ThrustCurve.LINEAR, lag=0.0)
    model = thrusters(ThrusterLayout((first, second), Damping.DIAGONAL))
    with pytest.raises(InputError, match=r"no record can distinguish the free parameters: .*k_f_one.*k_f_two"):
        refuse_unidentifiable(model, OUTPUTS)


def test_without_a_thrust_in_newtons_only_ratios_to_the_mass_are_identifiable() -> None:
    model = model_named("thrusters")
    refuse_unidentifiable(model, OUTPUTS)
    texts = [s.text for s in structural_symmetries(model, OUTPUTS)]
    assert any("M_u" in text and "k_f" in text for text in texts)


def test_commands_that_never_move_are_no_excitation() -> None:
    time = 0.1 * np.arange(100)
    channels = {"u": np.ones(100), "command_1": np.full(100, 0.5), "command_2": np.full(100, 0.5)}
    with pytest.raises(InputError, match="none of command_1, command_2 moves in still; record spins"):
        refuse_without_excitation(model_named("thrusters"), [Record.from_arrays("still", time, channels)])
