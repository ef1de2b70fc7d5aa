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
