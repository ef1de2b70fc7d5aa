"""A small trial of the waterjet craft: three straight-forward records and the trial file over them."""

from pathlib import Path

import numpy as np
import pytest

TRIAL = """
question = "does it work?"

[ship]
name = "craft"
L = 9.8

[[records]]
files = "*.csv"
header_lines = 1
validate = "c_*"
session = "day"
time = { column = "t", unit = "s" }

[records.channels]
u = { column = "surge", unit = "kn" }
r = { column = 4, unit = "deg/s" }
delta = { column = "nozzle", unit = "deg", positive = "port" }
v_j = { column = "jet", unit = "m/s" }
psi = { column = "heading", unit = "deg" }

[model]
name = "waterjet"
"""


def record_text(phase: float) -> str:
    """Forty seconds of a steered craft, columns t, surge, nozzle, yaw rate, heading, jet."""
    time = np.arange(0.0, 40.0, 0.1)
    rate = 5.0 * np.sin(0.2 * time + phase)
    heading = 25.0 * (np.cos(phase) - np.cos(0.2 * time + phase))
    nozzle = -20.0 * np.sign(np.sin(0.2 * time + phase + 0.3))
    rows = [
        f"{t:.1f},1.6,{d:.3f},{r:.6f},{p:.6f},1.866" for t, d, r, p in zip(time, nozzle, rate, heading, strict=True)
    ]
    return "\n".join(["t,surge,nozzle,yaw rate,heading,jet", *rows]) + "\n"


@pytest.fixture
def trial_folder(tmp_path: Path) -> Path:
    """Records a, b, c of two days and trial.toml."""
    for i, name in enumerate(("a_2024-05-01", "b_2024-05-02", "c_2024-05-02")):
        (tmp_path / f"{name}.csv").write_text(record_text(0.1 * i))
    (tmp_path / "trial.toml").write_text(TRIAL)
    return tmp_path


@pytest.fixture
def trial_file(trial_folder: Path) -> Path:
    """The trial file of `trial_folder`."""
    return trial_folder / "trial.toml"
