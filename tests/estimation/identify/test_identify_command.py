"""`seatrial identify` and `simulate` as a user sees them: what they say of their uncertainty, and what they refuse."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.conftest import WriteTrial

RUNS = {"a": 0.0, "b": 0.01, "c": -0.01, "d": 0.02, "e": -0.02, "v_f": 0.01}


def test_identify_states_what_the_records_determine(
    trial_of: WriteTrial, tmp_path: Path, run_command: Callable[..., int]
) -> None:
    """Five zigzags train, one is kept out."""
    assert run_command("identify", trial_of(RUNS), "--out", tmp_path / "out", "--json", tmp_path / "fit.json") == 0
    fit = json.loads((tmp_path / "fit.json").read_text())
    assert {"structural", "directions", "effective_parameters"} <= set(fit["identifiability"])
    assert all({"combination", "standard_deviation", "text"} <= set(d) for d in fit["identifiability"]["directions"])
    assert fit["identifiability"]["effective_parameters"] == 2
    assert {"method", "whiteness_p", "process", "measurement"} <= set(fit["noise_model"])
    (prediction,) = fit["validation"]
    assert prediction["extrapolation"]["index"] == pytest.approx(1.0, abs=0.3)
    bounded = [m for m in prediction["measures"].values() if m["lower"] is not None]
    assert len(bounded) == len([m for m in prediction["measures"].values() if m["simulated"] is not None])
    assert all(m["lower"] <= m["simulated"] <= m["upper"] for m in bounded)


def test_a_steered_manoeuvre_has_intervals_and_an_index(
    trial_of: WriteTrial, tmp_path: Path, run_command: Callable[..., int]
) -> None:
    assert run_command("identify", trial_of({"a": 0.0}), "--out", tmp_path / "fit") == 0
    options = ("--manoeuvre", "zigzag:20/20", "--out", tmp_path / "z.csv", "--json", tmp_path / "z.json")
    assert run_command("simulate", tmp_path / "fit" / "model.toml", *options, "--speed", "2") == 0
    table = json.loads((tmp_path / "z.json").read_text())
    low, high = table["intervals"]["overshoot_1_deg"]
    assert low < table["measures"]["overshoot_1_deg"] < high
    assert table["extrapolation_index"] > 1.0, "20 degrees of rudder after 17"


@pytest.mark.parametrize("kind", ["jackknife", "bootstrap", "profile"])
def test_every_kind_of_interval_can_be_had(
    trial_of: WriteTrial, tmp_path: Path, run_command: Callable[..., int], kind: str
) -> None:
    trial = trial_of(RUNS, more='[estimate]\nmethod = "multiple-shooting"', rows=300)
    arguments = ("--intervals", kind, "--out", tmp_path / "out", "--json", tmp_path / "fit.json")
    assert run_command("identify", trial, *arguments) == 0
    fit = json.loads((tmp_path / "fit.json").read_text())
    errors = {c["name"]: c for c in fit["coefficients"] if not c["fixed"]}
    assert all(c["lower"] < c["estimate"] < c["upper"] for c in errors.values())
    unjudged = [f["text"] for f in fit["findings"] if f["code"] == "no-comparison"]
    assert len(unjudged) == (kind == "jackknife"), "these records have no position by which windows are judged"
    assert bool(fit["identifiability"]["profiles"]) == (kind == "profile")


def test_prediction_error_has_profiles(trial_of: WriteTrial, tmp_path: Path, run_command: Callable[..., int]) -> None:
    trial = trial_of({"a": 0.0}, more='[estimate]\nmethod = "prediction-error"')
    arguments = ("--intervals", "profile", "--out", tmp_path / "out", "--json", tmp_path / "fit.json")
    assert run_command("identify", trial, *arguments) == 0
    fit = json.loads((tmp_path / "fit.json").read_text())
    assert fit["method"]["intervals"].startswith("profile likelihood; standard errors: ")
    profiles = {p["parameter"]: p for p in fit["identifiability"]["profiles"]}
    free = [c for c in fit["coefficients"] if not c["fixed"]]
    assert set(profiles) == {c["name"] for c in free}
    for c in free:
        profile, slack = profiles[c["name"]], 0.1 * (c["estimate"] - c["lower"])  # of errors that no profile knows
        assert profile["lower"] - slack <= c["lower"] <= profile["lower"]
        assert profile["upper"] <= c["upper"] <= profile["upper"] + slack


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--intervals", "jackknife"), "need at least 4 training runs, the trial has 1"),
        (("--intervals", "jacknife"), "unknown kind of intervals 'jacknife'; did you mean 'jackknife'"),
        (("--choose",), "needs at least 4 training runs; the trial has 1"),
    ],
)
def test_what_cannot_be_had_is_refused_in_one_sentence(
    trial_of: WriteTrial,
    tmp_path: Path,
    run_command: Callable[..., int],
    capsys: pytest.CaptureFixture,
    arguments: tuple[str, ...],
    says: str,
) -> None:
    out = tmp_path / "out"
    assert run_command("identify", trial_of({"a": 0.0}), "--out", out, *arguments) == 2
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("seatrial:")]
    assert len(said) == 1 and says in said[0]
    assert not out.exists() or not list(out.iterdir())


def test_the_same_seed_gives_the_same_file(
    trial_of: WriteTrial, tmp_path: Path, run_command: Callable[..., int]
) -> None:
    more = '[estimate]\nmethod = "output-error"'
    trial, measures = trial_of({"a": 0.0, "b": 0.01, "v_f": 0.01}, more=more), []
    for seed in (1, 1, 2):
        file = tmp_path / f"{seed}.json"
        assert run_command("identify", trial, "--out", tmp_path / "out", "--json", file, "--seed", seed) == 0
        measures.append(json.loads(file.read_text())["validation"][0]["measures"])
    assert measures[0] == measures[1] != measures[2]


def test_an_interrupt_during_refits_leaves_nothing_half_written(
    trial_of: WriteTrial, tmp_path: Path, run_command: Callable[..., int], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> np.ndarray:
        raise KeyboardInterrupt

    monkeypatch.setattr("seatrial.estimation.estimate.intervals.full_jackknife", interrupted)
    out = tmp_path / "out"
    trial = trial_of(RUNS, more='[estimate]\nmethod = "multiple-shooting"', rows=300)
    assert run_command("identify", trial, "--out", out, "--intervals", "jackknife") == 130
    assert not out.exists() or not list(out.iterdir())
