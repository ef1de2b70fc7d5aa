"""Results are those recorded, by the class of their trial; reproducers are right, or marked as not right yet."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from benchmarks.golden import (
    CLASSES,
    RECORDED,
    SUITE_CPU,
    Execute,
    GoldenTrial,
    data_folder,
    differences,
    in_a_process,
    is_wanted,
    read_trials,
    recordable,
    rows_of,
    run_trial,
    shortfalls,
)

TRIALS, WANTED = read_trials()
RESULTS = json.loads(RECORDED.read_text(encoding="utf-8"))
# above 2 s they are long; the start of a command takes one of them
QUICK = [t if t.cpu < 2.0 else pytest.param(t, marks=pytest.mark.long) for t in TRIALS if 0.0 < t.cpu < SUITE_CPU]
FIT: dict[str, Any] = {
    "exits": [0],
    "codes": ["sign-open"],
    "grade": "well",
    "coefficients": {"K": [0.15, 0.01, 0.13, 0.17]},
    "errors": {"run": {"psi_deg": 1.0}},
    "objectives": {"output": 2.0},
    "gains": {"KP": 1.0},
}


@pytest.fixture
def execute(
    run_command: Callable[..., int], capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Execute:
    """Runs the commands of a trial in this process: each would import everything anew."""

    def run(name: str, arguments: list[str], folder: Path) -> tuple[int, str]:
        if name == "python":
            return in_a_process(name, arguments, folder)
        monkeypatch.chdir(folder)
        monkeypatch.setenv("SEATRIAL_DATA", str(data_folder()))
        return run_command(name, *arguments), "".join(capfd.readouterr())

    return run


@pytest.mark.parametrize("trial", QUICK, ids=lambda trial: trial.name)
def test_a_quick_trial_gives_what_is_recorded(trial: GoldenTrial, execute: Execute) -> None:
    if not trial.is_here:
        pytest.skip("its records or the reproducers are not here")
    tolerance = "redraw" if trial.tolerance == "move" else trial.tolerance  # bits depend on the machine
    rows = rows_of(trial, run_trial(trial, execute)[0], RESULTS, tolerance)
    assert [row for row in rows if not is_wanted(row, WANTED)] == []


def test_every_trial_has_a_class_and_results_or_what_it_should_be() -> None:
    assert len({trial.name for trial in TRIALS}) == len(TRIALS)
    assert {trial.tolerance for trial in TRIALS} <= set(CLASSES)
    assert sorted(RESULTS) == sorted(trial.name for trial in TRIALS if not trial.should)
    assert [trial.name for trial in TRIALS if trial.fails and not trial.should] == []
    assert [trial.name for trial in TRIALS if " " in trial.fails] == []


def changed(**values: object) -> dict[str, Any]:
    return FIT | values


@pytest.mark.parametrize(
    ("present", "classes"),
    [
        (changed(), ""),
        (changed(coefficients={"K": [0.15 + 1e-12, 0.01, 0.13, 0.17]}), "move"),
        (changed(coefficients={"K": [0.15, 0.01, 0.1305, 0.17]}), "move redraw"),
        (changed(coefficients={"K": [0.152, 0.01, 0.13, 0.17]}), "move redraw replaced"),
        (changed(coefficients={}), "move redraw replaced"),
        (changed(codes=[]), "move redraw"),
        (changed(grade="closely"), "move redraw"),
        (changed(exits=[2]), "move redraw replaced"),
        (changed(errors={"run": {"psi_deg": 0.5}}), "move redraw"),
        (changed(errors={"run": {"psi_deg": 1.02}}), "move redraw replaced"),
        (changed(objectives={"output": 2.005}), "move"),
        (changed(objectives={"output": 2.03}), "move redraw replaced"),
        (changed(gains={"KP": 1.5}), "move redraw"),
    ],
)
def test_a_class_allows_what_it_says(present: dict[str, Any], classes: str) -> None:
    assert [name for name in CLASSES if list(differences(FIT, present, name))] == classes.split()


def test_a_difference_is_wanted_only_with_its_reason() -> None:
    row = "waterjet: coefficients.K estimate: 0.15 -> 0.152, 0.2 standard errors"
    entry = {"row": "waterjet: coefficients.K", "reason": "inputs are timed by the estimator"}
    assert is_wanted(row, [entry])
    assert not is_wanted(row, [entry | {"reason": ""}]) and not is_wanted(row.replace("K", "T"), [entry])


def test_a_reproducer_is_held_to_what_its_report_calls_right() -> None:
    outcome = FIT | {"text": "the clock\nstands still", "draft": "channels.psi = 1", "tuned": []}
    right = {"exits": [0, 2], "says": ["clock stands"], "never": ["nan"], "drafted": ["psi"], "not_drafted": ["OPEN"],
             "codes": ["sign-open"], "no_codes": ["gap"], "within": {"K": [0.1, 0.2]}, "holds": {"K": 0.16},
             "errors": {"psi_deg": 1.0}}  # fmt: skip
    wrong = {"exits": [2], "says": ["nan"], "never": ["clock"], "drafted": ["OPEN"], "not_drafted": ["psi"],
             "codes": ["gap"], "no_codes": ["sign-open"], "within": {"T": [0.1, 0.2]}, "holds": {"K": 0.18},
             "errors": {"psi_deg": 0.9}}  # fmt: skip
    assert shortfalls(right, outcome) == []
    assert len(shortfalls(wrong, outcome)) == len(wrong)
    trial = GoldenTrial("clock", "move", ("check log.csv",), should=wrong, fails="clocks")
    assert rows_of(trial, outcome, {}) == []
    assert len(rows_of(replace(trial, fails=""), outcome, {})) == len(wrong)
    assert rows_of(replace(trial, should=right), outcome, {}) == ["clock: is right now; strike fails = 'clocks'"]


def test_equal_plants_get_equal_gains() -> None:
    outcome = FIT | {"text": "", "tuned": [{"KP": 1.0}, {"KP": 1.02}]}
    assert shortfalls({"equal_gains": 0.03}, outcome) == []
    assert len(shortfalls({"equal_gains": 0.01}, outcome)) == 1


def test_times_and_texts_are_not_recorded() -> None:
    assert recordable({"exits": [0], "text": "", "draft": "", "files": {}, "tuned": []}) == {"exits": [0]}
