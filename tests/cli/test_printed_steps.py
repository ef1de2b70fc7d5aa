"""What `init` and `check` print to be typed is tried: it parses, and what it starts is possible."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from benchmarks.golden import GoldenTrial, expanded, read_trials

Run = Callable[..., int]
DRAFTED = [trial for trial in read_trials()[0] if trial.run[0].startswith("init ")]
COMMAND = re.compile(r"seatrial ((?:init|check|identify) [^\n]*)")
OPTION = re.compile(r"(--[a-z]+ (?:'[^'\n]+'|-?\d[\d.]*|[^\s=']+=\w+))")
EDIT = re.compile(r"set channels\.(\w+)\.(\w+ = \S+)")


def shortcomings(arguments: list[str], run: Run, capfd: pytest.CaptureFixture[str]) -> list[str]:
    """What of the steps that a draft, and the check of it, print cannot be done."""
    trial = arguments[arguments.index("--out") + 1]
    if run("init", *arguments) != 0:
        return []  # refused with a sentence: there is no next step
    text = capfd.readouterr().out
    faults = []
    for command in COMMAND.findall(text):
        name, *rest = shlex.split(command)
        if name == "identify":
            name, rest = "check", rest[:1]
        code = run(name, *rest, *(["--overwrite"] if name == "init" else []))
        checked = capfd.readouterr().out
        is_open = "decide what is OPEN" in text or "OPEN:" in Path(trial).read_text(encoding="utf-8")
        cannot = code != 0 or ("identify cannot start" in checked and not is_open)
        faults += [command] if cannot and not (is_open and name == "check") else []
        lines = {line.partition(" =")[0]: line for line in Path(trial).read_text(encoding="utf-8").splitlines()}
        faults += [edit for symbol, edit in EDIT.findall(checked) if edit in lines.get(f"channels.{symbol}", "")]
    advised = [line for line in text.splitlines() if line.startswith(("Next", "NOTE")) and "seatrial init" not in line]
    for option in (option for line in advised for option in OPTION.findall(line)):
        faults += [option] if run("init", *arguments, "--overwrite", *shlex.split(option)) != 0 else []
        capfd.readouterr()
    return faults


@pytest.mark.long
@pytest.mark.parametrize("golden", DRAFTED, ids=lambda golden: golden.name)
def test_what_a_golden_trial_prints_can_be_done(
    golden: GoldenTrial,
    run_command: Run,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    if not golden.is_here:
        pytest.skip("its records or the reproducers are not here")
    monkeypatch.chdir(golden.path)
    line = shlex.split(golden.run[0].replace("{out}", str(tmp_path)))
    assert shortcomings([path for part in line[1:] for path in expanded(part, golden.path)], run_command, capfd) == []


@pytest.mark.parametrize(
    ("headings", "advised"),
    [
        ("time,rudder [deg],Kurs ü. Kiel [°],fix", "--column 'Kurs ü. Kiel [°]=psi'"),
        ("time,rudder [deg],speed,fix", ""),
        ("time,heading [deg],Stellung [°],fix", ""),
    ],
)
def test_a_column_that_may_be_what_is_missing_is_advised(
    headings: str, advised: str, run_command: Run, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:  # fmt: skip
    time = np.arange(0.0, 100.0, 0.5)
    steered, state = 10.0 * np.sign(np.sin(0.1 * time)), np.mod(time, 4.0)
    other = 4.0 + 0.01 * time if "speed" in headings else 60.0 + 30.0 * np.sin(0.1 * time)
    columns = (time, other, steered, state) if "heading" in headings else (time, steered, other, state)
    rows = "\n".join(",".join(f"{cell:.3f}" for cell in row) for row in zip(*columns, strict=True))
    (tmp_path / "a.csv").write_text(f"{headings}\n{rows}\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    arguments = ["a.csv", "--length", "20", "--out", str(tmp_path / "t.toml")]
    assert run_command("init", *arguments) == 0
    (step,) = [line for line in capfd.readouterr().out.splitlines() if line.startswith("Next: ")]
    assert advised in step and ("--column" in step) is bool(advised)
    assert shortcomings([*arguments, "--overwrite"], run_command, capfd) == []
