"""A waterjet craft with sway under a heading loop, and the loop file of its track."""

from pathlib import Path

from tests.control.loop_files import AUTOPILOT, write_loop_file

from seatrial.control.loopfile.load import tuning_task
from seatrial.control.task import TuningTask
from seatrial.core.values import Ship
from seatrial.data.example_series import JET_VELOCITY, true_model
from seatrial.data.folder.model_file import ModelFile, write_model

TRACK = """
[track]
current = { value = 0.1, unit = "m/s" }
bandwidth = 0.002
"""
SEA = """
[hull]
L = 9.8
B = 3.2
T = 0.7
[[seas]]
spectrum = "sea-state"
state = 2
heading = { value = 135, unit = "deg" }
[demand]
"""


def track_task_of(folder: Path, *changes: tuple[str, str]) -> TuningTask:
    """Return the tuning of the craft's heading with a track, in a slow disturbance and a sea from the bow."""
    model = ModelFile(true_model(), ship=Ship("craft", {"L": 9.8}), approach={"u": 0.8, "v_j": JET_VELOCITY})
    write_model(model, folder / "model.toml")
    return tuning_task(write_loop_file(folder, AUTOPILOT + TRACK, ("[demand]\n", SEA), *changes))
