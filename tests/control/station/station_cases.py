"""A craft with four thrusters set at 45 degrees, one with azimuths, and the loop file of a station."""

import math
from pathlib import Path

import numpy as np
from tests.control.loop_files import write_loop_file

from seatrial.control.loopfile.load import tuning_task
from seatrial.control.station.craft import StationCraft
from seatrial.control.task import TuningTask
from seatrial.core.equations import Model
from seatrial.core.values import Ship
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.physics.models.thruster_layout import CommandInput, Damping, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.problems.thruster_craft import CRAFTS

VALUES = {
    "tau": 0.3, "tau_down": 0.2, "k_f": 60.0, "k_b": 45.0, "p_f": 1.8, "p_b": 1.6, "X_u": -8.0, "X_uu": -30.0,
    "Y_v": -20.0, "Y_vv": -90.0, "N_r": -5.0, "N_rr": -6.0, "N_ur": -6.0, "Y_uv": -30.0, "Y_NT": 0.0, "N_uv": 0.0,
    "M_u": 60.0, "M_v": 90.0, "M_r": 9.0,
}  # fmt: skip
"""Coefficients of `cross_drive`, SI."""
LOOP = """
[plant]
model = "model.toml"
[controller]
kind = "pid"
[actuator]
limit = 0.5
dead_time = 0.1
[hull]
L = 1.2
B = 0.8
T = 0.15
[[slow_disturbances]]
rms = 0.002
bandwidth = 0.2
[demand]
change = 0.3
[station]
current = 0.25
current_rms = 0.04
bandwidth = 0.05
gust = 5
gust_bandwidth = 0.2
"""


def cross_drive() -> Model:
    """Return a craft with a thruster at each corner, set at 45 degrees to the bow, its thrust known in newtons."""
    corners = (("port_bow", 0.45, -0.35, 1), ("starboard_bow", 0.45, 0.35, -1), ("starboard_stern", -0.45, 0.35, 1),
               ("port_stern", -0.45, -0.35, -1))  # fmt: skip
    four = tuple(
        Thruster(name, x, y, CommandInput(f"command_{k}"), side * math.pi / 4.0, bollard=60.0 if k == 1 else 0.0,
                 same_as="" if k == 1 else "port_bow")
        for k, (name, x, y, side) in enumerate(corners, start=1)
    )  # fmt: skip
    return thrusters(ThrusterLayout(four, Damping.FULL, 1.2, 60.0)).with_values(VALUES)


def azimuths() -> Model:
    """Return the ferry with four azimuths of the benchmark problems."""
    return CRAFTS["azimuths"].truth


def craft(model: Model, spread: float = 0.0) -> StationCraft:
    """Return a craft on station; spread: standard deviation of each free coefficient over its value."""
    free = model.parameters.free
    covariance = np.diag([(spread * p.value) ** 2 for p in free]) if spread else np.empty((0, 0))
    return StationCraft(model, covariance)


def station_task(folder: Path, *changes: tuple[str, str]) -> TuningTask:
    """Return the tuning of the craft's heading with a station."""
    ship = Ship("craft", {"L": 1.2})
    write_model(ModelFile(cross_drive(), ship=ship), folder / "model.toml")
    return tuning_task(write_loop_file(folder, LOOP, *changes))
