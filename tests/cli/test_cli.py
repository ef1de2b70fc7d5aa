"""The command line: help is quick and shows examples; bad input is one line and exit code 2."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.fits import example_fit

from seatrial.core.values import Ship
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.data.folder.result_folder import save_result
from seatrial.physics.models import model_named

COMMANDS = ("check", "identify", "design", "simulate", "report", "demo", "reproduce")
HEAVY = ("numpy", "numba", "sympy", "pandas", "pydantic", "matplotlib", "scipy")


@pytest.fixture
def model_file(tmp_path: Path) -> Path:
    path = tmp_path / "model.toml"
    write_model(ModelFile(model_named("waterjet"), ship=Ship("craft", {"L": 9.8}), approach={"v_j": 1.866}), path)
    return path


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_an_example(command: str, run_command: Callable[..., int], capsys: pytest.CaptureFixture) -> None:
    assert run_command(command, "--help") == 0
    said = capsys.readouterr().out
    assert f"Example: seatrial {command}" in said
    assert "--json" in said
    assert "--seed" in said


def test_help_imports_nothing_heavy() -> None:
    script = (
        "import sys; sys.argv = ['seatrial', '--help']\n"
        "import seatrial.cli as c\n"
        "try: c.main()\n"
        "except SystemExit: pass\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules])"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert said.splitlines()[-1] == "[]"


def test_bad_input_is_one_line_and_exit_code_2(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    assert run_command("check", tmp_path / "absent.toml") == 2
    said = capsys.readouterr().err
    assert said.startswith("seatrial: trial file")
    assert said.count("\n") == 1


def test_a_folder_that_cannot_be_written_is_refused_before_the_work(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    (tmp_path / "file").write_text("")
    assert run_command("identify", tmp_path / "absent.toml", "--out", tmp_path / "file" / "folder") == 2
    assert "cannot be written" in capsys.readouterr().err


def test_json_that_cannot_be_written_is_refused_before_the_work(
    model_file: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    out = tmp_path / "out.csv"
    arguments = ("simulate", model_file, "--manoeuvre", "zigzag:20/20", "--out", out, "--json", tmp_path)
    assert run_command(*arguments) == 2
    assert "is a folder; name a file" in capsys.readouterr().err
    assert not out.exists()


def test_an_unknown_study_is_refused(run_command: Callable[..., int], capsys: pytest.CaptureFixture) -> None:
    assert run_command("reproduce", "nobody1900") == 2
    assert "unknown study 'nobody1900'" in capsys.readouterr().err


def test_an_interrupt_ends_with_a_sentence(
    tmp_path: Path, run_command: Callable[..., int], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("seatrial.api.check", interrupted)
    assert run_command("check", tmp_path / "any.toml") == 130
    assert "seatrial: interrupted" in capsys.readouterr().err


def test_a_model_file_is_steered(
    model_file: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    arguments = ("--manoeuvre", "zigzag:20/20", "--out", tmp_path / "z.csv", "--json", tmp_path / "z.json")
    assert run_command("simulate", model_file, *arguments) == 0
    assert "1st overshoot, deg" in capsys.readouterr().out
    assert json.loads((tmp_path / "z.json").read_text())["measures"]["overshoot_1_deg"] > 0.0


def test_a_simulated_record_replays_to_itself(
    model_file: Path, tmp_path: Path, run_command: Callable[..., int]
) -> None:
    one, two = tmp_path / "one.csv", tmp_path / "two.csv"
    assert run_command("simulate", model_file, "--manoeuvre", "turning-circle:20", "--out", one) == 0
    assert run_command("simulate", model_file, "--inputs", one, "--out", two) == 0
    assert one.read_text().splitlines()[-1] == two.read_text().splitlines()[-1]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--manoeuvre", "zigzak:20/20"), "unknown manoeuvre"),
        ((), "give either --manoeuvre or --inputs"),
        (("--manoeuvre", "zigzag:20/20", "--set", "v_j"), "NAME=VALUE"),
        (("--manoeuvre", "zigzag:20/20", "--set", "n=3"), "'n' is no held input"),
        (("--inputs", "absent.csv"), "absent.csv"),
    ],
)
def test_simulate_refuses_in_one_sentence(
    model_file: Path,
    tmp_path: Path,
    run_command: Callable[..., int],
    capsys: pytest.CaptureFixture,
    arguments: tuple[str, ...],
    says: str,
) -> None:
    assert run_command("simulate", model_file, *arguments, "--out", tmp_path / "out.csv") == 2
    assert says in capsys.readouterr().err


def test_a_model_file_whose_covariance_is_none_is_refused(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    model = model_named("waterjet")
    broken = np.eye(len(model.parameters.free))
    broken[0, 1] = broken[1, 0] = 2.0
    write_model(ModelFile(model, broken, ship=Ship("craft", {"L": 9.8})), tmp_path / "model.toml")
    out = tmp_path / "z.csv"
    assert run_command("simulate", tmp_path / "model.toml", "--manoeuvre", "zigzag:20/20", "--out", out) == 2
    said = capsys.readouterr().err
    assert "covariance is not positive definite (smallest eigenvalue -1 " in said
    assert said.count("\n") == 1
    assert not out.exists()


def test_a_voyage_in_waves_is_replayed_beside_its_record(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture, repository: Path
) -> None:
    trial = repository / "examples" / "heave_pitch.toml"
    model = save_result(example_fit("heave_pitch"), tmp_path / "fit") / "model.toml"
    replayed = ("--trial", trial, "--inputs", "voyage_held_out", "--out", tmp_path / "run.csv")
    assert run_command("simulate", model, *replayed, "--json", tmp_path / "run.json") == 0
    assert "against voyage_held_out: rms pitch" in capsys.readouterr().out
    predicted = json.loads((tmp_path / "fit" / "result.json").read_text())["predictions"][-1]["rms"]
    assert json.loads((tmp_path / "run.json").read_text())["rms"]["z"] == pytest.approx(predicted["z"], rel=0.1)
