"""`seatrial tune --verify`: from logs to screen, JSON and page, and back from the folder."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from benchmarks.verification import EXAMPLE, simulated_log

import seatrial as st

TRIAL = """
[data]
folder = "."
[[records]]
files = "leg_*.csv"
header_lines = 1
time = { column = "time [s]", unit = "s" }
[records.channels]
phi = { column = "phi [rad]", unit = "rad" }
alpha_f = { column = "alpha_f [rad]", unit = "rad" }
"""


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("logs")
    for record in simulated_log(st.load_loop(EXAMPLE), np.zeros(3), 3, 600.0).records:
        st.write_record(record, folder / f"{record.name}.csv")
    (folder / "gains.toml").write_text("[gains]\nKP = 11.053\nKI = 0.428\nKD = 32.736\n")
    return folder


def test_logs_become_a_page_and_come_back(
    logs: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    out, names = tmp_path / "out", [("--verify", logs / f"leg_{k}.csv") for k in range(1, 5)]
    options = [word for pair in names for word in pair]
    gains = logs / "gains.toml"
    assert run_command("tune", EXAMPLE, *options, "--gains", gains, "--out", out, "--json", tmp_path / "v.json") == 0
    printed = capsys.readouterr().out
    assert "as predicted" in printed
    assert "K_alpha" in printed
    assert json.loads((tmp_path / "v.json").read_text())["outside"] == []
    page = (out / "report.html").read_text()
    assert "leg_2" in page
    assert st.load(out).outside == ()
    assert run_command("report", out) == 0
    assert (out / "report.html").read_text() == page


def test_a_trial_file_names_the_logs(logs: Path) -> None:
    trial = logs / "trial.toml"
    trial.write_text(TRIAL)
    by_trial = st.verify(EXAMPLE, logs / "gains.toml", [trial])
    by_files = st.verify(EXAMPLE, logs / "gains.toml", [logs / f"leg_{k}.csv" for k in range(1, 5)])
    assert by_trial.quantities[0].achieved == pytest.approx(by_files.quantities[0].achieved)


@pytest.mark.parametrize("options", [("--gains", "gains.toml"), ("--verify", "log.csv")])
def test_log_and_gains_go_together(options: tuple[str, ...], run_command: Callable[..., int]) -> None:
    assert run_command("tune", EXAMPLE, *options) == 2
