"""Heading and speed of a craft with thrusters as plants of loops: by orders, about a straight run."""

from pathlib import Path

import numpy as np
import pytest
from tests.control.loop_files import model_file, write_loop_file

from seatrial.control.loopfile.load import tuning_task
from seatrial.control.ship import steering_input
from seatrial.core.equations import Model
from seatrial.physics.models import model_named
from seatrial.physics.models.thrust_orders import AHEAD, YAW
from seatrial.physics.models.thruster_layout import AngleInput, CommandInput, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters

LOOP = """
[plant]
model = "model.toml"
[controller]
kind = "pid"
[actuator]
limit = 0.5
[[slow_disturbances]]
rms = 0.05
bandwidth = 0.2
[demand]
change = 0.3
"""


@pytest.fixture(scope="module")
def craft() -> Model:
    """A lag, thrust with the square of the command, quadratic drag ahead, linear damping in sway and yaw."""
    return model_named("thrusters").with_values({
        "k_f": 1.6, "k_b": 1.6, "p_f": 2.0, "p_b": 2.0, "k_J": 0.0, "X_uu": -0.8, "N_r": -0.2, "N_rr": 0.0, "N_ur": 0.0,
        "Y_uv": 0.0, "M_v": 1.0, "M_r": 0.15, "tau": 0.3, "tau_down": 0.3,
    })  # fmt: skip


def test_the_heading_is_steered_by_a_yaw_order_about_half_ahead(tmp_path: Path, craft: Model) -> None:
    """psi over order: d(thrust)/dc = 2 k_f c on two arms of 0.3 m, over s (M_r s - N_r) (tau s + 1)."""
    model_file(tmp_path, craft)
    task = tuning_task(write_loop_file(tmp_path, LOOP))
    assert (task.loop.output, task.loop.actuator) == ("psi", YAW)
    assert pytest.approx(2.0 * 0.5) == task.U
    s = 1j * np.geomspace(0.1, 10.0, 20)
    expected = 2.0 * 0.3 * 2.0 * 1.6 * 0.5 / (s * (0.15 * s + 0.2) * (0.3 * s + 1.0))
    assert np.allclose(task.loop.plant.frequency_response(s.imag), expected, rtol=1e-6)


def test_the_heading_of_an_outboard_is_steered_by_its_angle_thrust_held(tmp_path: Path) -> None:
    """psi over order, M_v = M_u, no sway coupling: |x| T over s (M_r s - N_r), to starboard; the lag is thrust's."""
    turned = Thruster("outboard", -2.0, 0.0, CommandInput("command_1"), angle=AngleInput("alpha_1"))
    values = dict.fromkeys(("X_u", "N_rr", "N_ur", "N_uv", "Y_uv", "Y_NT", "k_J"), 0.0)
    model_file(tmp_path, thrusters(ThrusterLayout((turned,), length=4.0)).with_values(
        values | {"k_f": 0.8, "p_f": 2.0, "X_uu": -0.1, "N_r": -1.5, "M_v": 1.0, "M_r": 2.0}
    ))  # fmt: skip
    task = tuning_task(write_loop_file(tmp_path, LOOP.replace("[plant]", "[plant]\nspeed = 2.0")))
    assert (task.loop.output, task.loop.actuator) == ("psi", "delta") and "alpha_1 = -delta" in task.plant
    s, thrust = 1j * np.geomspace(0.1, 10.0, 20), 0.1 * 2.0**2
    expected = 2.0 * thrust / (s * (2.0 * s + 1.5))
    assert np.allclose(task.loop.plant.frequency_response(s.imag), expected, rtol=1e-6)


def test_the_speed_is_held_by_the_order_ahead_that_it_needs(tmp_path: Path, craft: Model) -> None:
    """Drag 0.8 u^2 balances 2 k_f c^2: half ahead at 1 m/s; its slope 1.6 u is the pole."""
    model_file(tmp_path, craft)
    text = LOOP.replace("[plant]", '[plant]\noutput = "u"\nspeed = 1.0')
    task = tuning_task(write_loop_file(tmp_path, text))
    assert (task.loop.output, task.loop.actuator) == ("u", AHEAD)
    assert task.trimmed_ship is not None
    assert dict(zip(task.trimmed_ship.model.input_names, task.trimmed_ship.inputs, strict=True)) == pytest.approx(
        {AHEAD: 0.5, YAW: 0.0}, abs=1e-9
    )
    s = 1j * np.geomspace(0.1, 10.0, 20)
    expected = 2.0 * 1.6 * 2.0 * 0.5 / ((s + 1.6) * (0.3 * s + 1.0))
    assert np.allclose(task.loop.plant.frequency_response(s.imag), expected, rtol=1e-6)
    assert steering_input(task.trimmed_ship.model) == YAW
