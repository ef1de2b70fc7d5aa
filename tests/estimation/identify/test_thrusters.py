"""Craft with thrusters identified: what the commands cannot tell apart is refused by name, and what never moves."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError, Record, Ship
from seatrial.data.trial import EstimateMethod, EstimateSettings, Run, Trial
from seatrial.estimation.estimate.fit import refuse_without_excitation
from seatrial.estimation.identify import identify
from seatrial.estimation.information.symmetries import refuse_unidentifiable, structural_symmetries
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_layout import CommandInput, Damping, ThrustCurve, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.replay import replay

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


def test_thrusters_that_always_work_together_are_refused_with_the_direction() -> None:
    """Bow and stern thruster on the centre line, both ordered alike in every run: only their sum shows."""
    layout = ThrusterLayout(
        tuple(
            Thruster(name, x, 0.0, CommandInput(f"command_{k}"), curve=ThrustCurve.LINEAR, lag=0.0)
            for k, (name, x) in enumerate((("bow", 0.4), ("stern", -0.4)), start=1)
        ),
        Damping.DIAGONAL,
    )
    model, rng, time = thrusters(layout), np.random.default_rng(0), 0.1 * np.arange(400)
    losses = [f"{loss}_{name}" for loss in ("k_J", "k_4") for name in ("bow", "stern")]
    model = model.with_parameters(model.parameters.fixed(*losses))
    orders = np.repeat(rng.uniform(-1.0, 1.0, 20), 20)
    planned = Record.from_arrays("run", time, {"command_1": orders, "command_2": orders})
    clean = replay(model.with_values({"X_u": -0.3}), planned, dict.fromkeys(model.states, 0.0) | {"r": 0.3})
    noisy = {c: clean.channel(c).with_values(clean[c] + 0.02 * rng.standard_normal(400)) for c in OUTPUTS}
    trial = Trial(
        Ship("craft", {"L": 1.0}), (Run(replace(planned, channels=dict(planned.channels) | noisy)),), model,
        estimate=EstimateSettings(method=EstimateMethod.OUTPUT_ERROR),
    )  # fmt: skip
    with pytest.raises(InputError, match=r"do not determine the direction .*k_[fb]_(bow|stern) .*k_[fb]_(bow|stern)"):
        identify(trial)


def test_commands_that_never_move_are_no_excitation() -> None:
    time = 0.1 * np.arange(100)
    channels = {"u": np.ones(100), "command_1": np.full(100, 0.5), "command_2": np.full(100, 0.5)}
    with pytest.raises(InputError, match="none of command_1, command_2 moves in still; record spins"):
        refuse_without_excitation(model_named("thrusters"), [Record.from_arrays("still", time, channels)])
