"""A small trial with three runs, for campaigns over trial files."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.data.example_series import simulate_run, true_model, with_sensor_noise, write_csv

TRIAL = """
[ship]
name = "waterjet craft"
L = 9.8
d = 0.71
m = 5540.0

[data]
folder = "runs"

[[records]]
files = "*.csv"
header_lines = 1
validate = ["zigzag_30_30"]
kind = "simulated"
time = { column = "time [s]", unit = "s" }

[records.channels]
x0 = { column = "x0 [m]", unit = "m" }
y0 = { column = "y0 [m]", unit = "m" }
psi = { column = "psi [deg]", unit = "deg" }
u = { column = "u [m/s]", unit = "m/s" }
v = { column = "v [m/s]", unit = "m/s" }
r = { column = "r [deg/s]", unit = "deg/s" }
delta = { column = "delta [deg]", unit = "deg", positive = "starboard" }
v_j = { column = "v_j [m/s]", unit = "m/s" }

[model]
name = "waterjet"
free = ["Y_v", "Y_r", "N_v", "N_r"]
"""


@pytest.fixture(scope="session")
def trial_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with trial.toml and its records in a folder of their own."""
    folder = tmp_path_factory.mktemp("trial")
    craft, rng = true_model(), np.random.default_rng(24)
    for angle in (10, 20, 30):
        run = with_sensor_noise(simulate_run(craft, f"zigzag:{angle}/{angle}"), rng, 24).resampled(2.0)
        write_csv(run, folder / "runs" / f"{run.name}.csv")
    (folder / "trial.toml").write_text(TRIAL)
    return folder
