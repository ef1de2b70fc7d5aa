"""`seatrial models`: every built-in model in the table and in the JSON."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.physics.models import MODELS


def test_every_model_is_listed(run_command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert run_command("models", "--json", tmp_path / "models.json") == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in MODELS)
    assert set(MODELS) <= {entry["name"] for entry in json.loads((tmp_path / "models.json").read_text())["models"]}


def test_of_one_model_it_says_what_it_needs_and_how_to_begin(
    run_command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    assert run_command("models", "mmg", "--json", tmp_path / "mmg.json") == 0
    printed = capsys.readouterr().out
    assert "\nL = 0.0" in printed and "\nwhere recorded: wind_speed and wind_direction" in printed
    for part in (
        "records need delta and n, and",
        "t_P (prior sd 0.05)",
        "Harvald 1983",
        "# C_b = 0.0",
        "priors_from = [",
    ):
        assert part in printed
    assert json.loads((tmp_path / "mmg.json").read_text())["needed"]["D_P"] == "m, propeller diameter"
    assert run_command("models", "nomoto") == 0
    assert "records need delta, and one or more of r, psi" in capsys.readouterr().out
