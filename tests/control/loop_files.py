"""Loop files for tests: minimal ones of fins, autopilots and ride control, and what changes one line of them."""

from dataclasses import replace
from pathlib import Path

from seatrial.control.task import TuningTask
from seatrial.core.equations import Model
from seatrial.core.values import Ship
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.physics.models import model_named
from seatrial.physics.models.published import theoretical_coefficients

FIN = """
[plant]
roll = { num = [1.0], den = [1.43242, 0.3796, 1.0] }
speed = { value = 18, unit = "kn" }
[plant.fin]
K_alpha = 0.256
[controller]
kind = "yu2014"
[actuator]
limit = { value = 22, unit = "deg" }
rate = { value = 25, unit = "deg/s" }
[[seas]]
spectrum = "ittc"
height = 3.3
heading = { value = 90, unit = "deg" }
"""

AUTOPILOT = """
[plant]
model = "model.toml"
[controller]
kind = "pid"
parts = ["KP", "KD"]
[actuator]
limit = { value = 35, unit = "deg" }
rate = { value = 3, unit = "deg/s" }
[[slow_disturbances]]
rms = { value = 1, unit = "deg" }
bandwidth = 0.05
[demand]
change = { value = 20, unit = "deg" }
"""

PATROL_BOAT = """
name = "patrol boat"
[plant]
response = { num = [0.16], den = [4.0, 1.0, 0.0] }
output = "psi"
actuator = "delta"
speed = 9.0
[controller]
kind = "pid"
[actuator]
limit = { value = 35, unit = "deg" }
rate = { value = 8, unit = "deg/s" }
dead_time = 0.5
[[slow_disturbances]]
rms = { value = 2, unit = "deg" }
bandwidth = 0.05
[demand]
change = { value = 30, unit = "deg" }
time_constant = 10.0
"""

RIDE_CONTROL = """
minimise = [{ name = "vertical_acceleration", x = 20 }, "actuator_rate"]
[plant]
model = "model.toml"
output = "theta"
actuator = "delta_f1"
speed = { value = 18, unit = "kn" }
[controller]
kind = "pid"
parts = ["KP", "KD"]
derivative_filter = 0.1
[actuator]
limit = { value = 20, unit = "deg" }
rate = { value = 30, unit = "deg/s" }
servo = [{ num = [225.0], den = [1.0, 21.0, 225.0] }]
[excitation]
source = "box"
[[seas]]
spectrum = "ittc"
height = 1.5
heading = { value = 135, unit = "deg" }
"""


def write_loop_file(folder: Path, text: str, *changes: tuple[str, str]) -> Path:
    """The file with some of its text changed; what is to be changed must be there."""
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "loop.toml"
    path.write_text(text, encoding="utf-8")
    return path


def in_continuous_time(task: TuningTask) -> TuningTask:
    """The task with controllers that neither sample nor act late, as closed forms have them."""
    loops = (replace(one, sampling=None) for one in task.extended_structures)
    return replace(task, loop=replace(task.loop, sampling=None), extended_structures=tuple(loops))


def nomoto() -> Model:
    """A ship that answers in ten seconds, at 7 m/s."""
    return model_named("nomoto").with_values({"K": 0.08, "T": 10.0, "U": 7.0})


def roll() -> Model:
    """A ship that rolls in 7.5 s, damped more the more it rolls, without fins."""
    return model_named("roll").with_values({"b_1": 0.06, "b_2": 0.35, "c_1": 0.698})


def heave_and_pitch() -> Model:
    """The ship of Qi et al. 2025 at 135 degrees to the waves, with a fin aft."""
    ship = theoretical_coefficients(135).applied_to(model_named("heave_pitch"))
    return ship.with_values({"lift_1": 791060.0, "x_f1": -25.0})


def heave_pitch_file(folder: Path) -> Path:
    """The model of `heave_and_pitch` as `identify` writes it."""
    path = folder / "model.toml"
    write_model(ModelFile(heave_and_pitch(), ship=Ship("a ship", {"L": 60.0, "B": 7.137, "d": 2.27})), path)
    return path


def model_file(folder: Path, model: Model, name: str = "model.toml") -> Path:
    """The model as `identify` writes it, of a ship of 100 m."""
    path = folder / name
    write_model(ModelFile(model, ship=Ship("a ship", {"L": 100.0, "B": 10.5, "d": 3.4})), path)
    return path
