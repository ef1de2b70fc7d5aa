"""`seatrial export`: what it lists, writes and refuses."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.physics.models.published import kvlcc2


@pytest.fixture
def model_path(tmp_path: Path) -> Path:
    """A model file."""
    write_model(ModelFile(kvlcc2()), tmp_path / "model.toml")
    return tmp_path / "model.toml"


def test_the_list_says_what_suits_a_model(
    run_command: Callable[..., int], model_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command("export", model_path, "--list", "--json", model_path.parent / "list.json") == 0
    assert "c99" in capsys.readouterr().out
    targets = json.loads((model_path.parent / "list.json").read_text())["targets"]
    assert targets["c99"] == ""


def test_an_export_says_where_it_lies(
    run_command: Callable[..., int], model_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = model_path.parent / "ship"
    assert run_command("export", model_path, "--to", "c99", "--out", out) == 0
    assert f"exported: {out}" in capsys.readouterr().out
    assert sorted(p.name for p in out.iterdir()) == ["ship.c", "ship.h"]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((), "give --to TARGET and --out PATH"),
        (("--to", "c98", "--out", "ship"), "unknown target 'c98'; did you mean 'c99'?"),
    ],
)
def test_bad_input_is_one_sentence(
    run_command: Callable[..., int], model_path: Path, capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...], sentence: str,
) -> None:  # fmt: skip
    assert run_command("export", model_path, *arguments) == 2
    assert sentence in capsys.readouterr().err
