"""Records and trials that cannot be identified: one sentence on standard error, exit code 2, no result folder."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.conftest import WriteTrial

Spoil = Callable[[Path], None]


def columns(path: Path) -> tuple[str, np.ndarray]:
    lines = path.read_text().splitlines()
    return lines[0], np.array([[float(cell or "nan") for cell in line.split(",")] for line in lines[1:]])


def rewrite(path: Path, header: str, table: np.ndarray) -> None:
    rows = [",".join("" if np.isnan(cell) else f"{cell:.12g}" for cell in row) for row in table]
    path.write_text("\n".join([header, *rows]) + "\n")


def still(folder: Path) -> None:
    for path in folder.glob("*.csv"):
        header, table = columns(path)
        table[:, 4] = 0.1
        rewrite(path, header, table)


def empty(column: int) -> Spoil:
    def spoil(folder: Path) -> None:
        header, table = columns(folder / "a.csv")
        table[:, column] = np.nan
        rewrite(folder / "a.csv", header, table)

    return spoil


def shortened(rows: int) -> Spoil:
    def spoil(folder: Path) -> None:
        header, table = columns(folder / "a.csv")
        rewrite(folder / "a.csv", header, table[:rows])

    return spoil


def without(*channels: str) -> Spoil:
    def spoil(folder: Path) -> None:
        lines = (folder / "trial.toml").read_text().splitlines()
        kept = [line for line in lines if not line.startswith(tuple(f"{c} = " for c in channels))]
        (folder / "trial.toml").write_text("\n".join(kept))

    return spoil


def nothing(_: Path) -> None:
    pass


CASES: dict[str, tuple[str, Spoil, str]] = {
    "no excitation": ("", still, "no excitation: 'delta' never moves in a, b; record a zigzag"),
    "no influence": ("free = ['K', 'T', 'U']", nothing, "U enters no equation that reaches r or psi"),
    "too short to tell": ("", shortened(2), "record 'a' has 2 samples; at least three are needed"),
    "diverging at once": (
        "fixed = { T = -0.02 }",
        nothing,
        r"model 'nomoto' diverges within [\d.]+ s in run 'a'",
    ),
    "nothing free": ("free = []", nothing, "no free parameter"),
    "unknown parameter": ("fixed = { TT = 3.0 }", nothing, "unknown parameter 'TT'; did you mean 'T'"),
    "bounds crossed": ("bounds = { T = [3.0, 2.0] }", nothing, r"model\.bounds\.T: lower bound 3 is not below"),
    "start outside": ("bounds = { T = [3.0, 4.0] }\nstart = { T = 7.0 }", nothing, "'T' starts at 7, outside"),
    "empty output": ("", empty(3), r"'psi'\) holds no number at all"),
    "empty input": ("", empty(4), r"'delta'\) holds no number at all"),
    "one sample": ("", shortened(1), "one sample"),
    "no outputs": ("", without("r", "psi"), "no record holds any output of model 'nomoto': r, psi, x0, y0"),
    "no input": ("", without("delta"), "record 'a' has no channel 'delta', an input of model 'nomoto'"),
}


@pytest.mark.parametrize("name", CASES)
def test_one_sentence_and_exit_code_2(
    name: str, trial_of: WriteTrial, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    model, spoil, says = CASES[name]
    path = trial_of({"a": 0.0, "b": 0.0}, model=model)
    spoil(path.parent)
    out = path.parent / "result"
    assert run_command("identify", path, "--out", out) == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.startswith("seatrial: ")
    assert re.search(says, last), last
    assert not list(out.glob("*"))


@pytest.mark.long
def test_runs_that_a_wrong_value_cannot_repeat_are_said_to_diverge(
    trial_of: WriteTrial, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    path = trial_of({"a": 0.0, "b": 0.0}, model="fixed = { T = -3.0 }")
    assert run_command("identify", path, "--out", path.parent / "result") == 0
    assert "warning [diverged] training run 'a' diverges" in capsys.readouterr().out
