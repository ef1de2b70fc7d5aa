"""Axes of a pose beside GNSS fixes: east-north-up or north-east-down, with the antenna off the pose's point."""

from pathlib import Path

import numpy as np
import pymap3d
import pytest
from tests.data.draft.test_draft import STEP, TRUTH, write

from seatrial.api import draft_trial


def _fixes(forward: float) -> dict[str, np.ndarray]:
    north = TRUTH["x0"] + forward * np.cos(TRUTH["psi"])
    east = TRUTH["y0"] + forward * np.sin(TRUTH["psi"])
    lat, lon, _ = pymap3d.enu2geodetic(east, north, 0.0, 60.0, 5.0, 0.0)
    return {"time": TRUTH["t"], "latitude": lat, "longitude": lon}


def _pose(*, is_enu: bool) -> dict[str, np.ndarray]:
    yaw = np.pi / 2.0 - TRUTH["psi"] if is_enu else TRUTH["psi"]
    x, y = (TRUTH["y0"], TRUTH["x0"]) if is_enu else (TRUTH["x0"], TRUTH["y0"])
    turn = {"pose_orientation_z": np.sin(0.5 * yaw), "pose_orientation_w": np.cos(0.5 * yaw)}
    none = {"pose_orientation_x": 0.0 * yaw, "pose_orientation_y": 0.0 * yaw}
    return {"time": TRUTH["t"], "pose_position_x": x, "pose_position_y": y} | none | turn


@pytest.mark.parametrize("is_enu", [True, False])
def test_fixes_decide_the_axes_and_with_them_the_sides(is_enu: bool, tmp_path: Path) -> None:
    side = -1.0 if is_enu else 1.0
    body = {"twist_linear_x": TRUTH["u"], "twist_linear_y": side * TRUTH["v"], "twist_angular_z": side * TRUTH["r"]}
    write(tmp_path / "fix.csv", _fixes(2.0))
    write(tmp_path / "pose.csv", _pose(is_enu=is_enu))
    write(tmp_path / "twist_body.csv", {"time": TRUTH["t"]} | body)
    used = {g.symbol: g for part in draft_trial(tmp_path).guesses for g in part if g.is_used}
    assert not any(used[symbol].is_open for symbol in ("x0", "y0", "q_w", "q_z", "u", "v", "r"))
    assert used["x0"].frame == used["q_w"].frame == ("enu" if is_enu else "earth")
    assert used["v"].positive == used["r"].positive == ("port" if is_enu else "")
    assert "lat" not in used


def test_a_straight_line_to_the_north_east_leaves_the_axes_open(tmp_path: Path) -> None:
    along = 3.0 * STEP * np.arange(TRUTH["t"].size)
    lat, lon, _ = pymap3d.enu2geodetic(along, along, 0.0, 60.0, 5.0, 0.0)
    write(tmp_path / "fix.csv", {"time": TRUTH["t"], "latitude": lat, "longitude": lon})
    write(tmp_path / "pose.csv", {"time": TRUTH["t"], "pose_position_x": along, "pose_position_y": along})
    used = {g.symbol: g for part in draft_trial(tmp_path).guesses for g in part if g.is_used}
    assert used["x0"].is_open and used["y0"].is_open
