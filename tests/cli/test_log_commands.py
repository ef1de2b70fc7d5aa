"""`seatrial init` and `seatrial check` on bare logs and on drafted files."""

from pathlib import Path

import pytest
from tests.data.draft.test_draft import BASE, TRUTH, write
from tests.data.read.samples import SAMPLES
from typer.testing import CliRunner

from seatrial.cli.commands import app
from seatrial.core.values import InputError

RUNNER = CliRunner()


def output(*arguments: str) -> str:
    result = RUNNER.invoke(app, list(arguments), catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_a_bare_log_is_listed(tmp_path: Path) -> None:
    SAMPLES["run.bin"].write(tmp_path / "run.bin")
    text = output("check", str(tmp_path / "run.bin"))
    for part in ("run.bin: ardupilot-bin, 1 topic", "XKF1: 60 rows, 5 Hz, 11.8 s", "-> u", "MODE AUTO", "2 parameters"):
        assert part in text
    assert "Next: seatrial init" in text


def test_a_draft_is_written_once_and_checked(tmp_path: Path) -> None:
    log, trial = write(tmp_path / "run.csv", BASE | {"rot": TRUTH["r"]}), tmp_path / "trial.toml"
    text = output("init", str(log), "--out", str(trial))
    assert "follows d(psi)/dt" in text and "zigzag1, " in text and "Next: seatrial check" in text
    assert "zigzag1" in trial.with_suffix(".html").read_text(encoding="utf-8")
    with pytest.raises(InputError, match="exists and is not overwritten"):
        output("init", str(log), "--out", str(trial))
    assert "Next: " in output("check", str(trial))
    trial.unlink()
    with pytest.raises(InputError, match="the drawing beside --out, exists"):
        output("init", str(log), "--out", str(trial))
