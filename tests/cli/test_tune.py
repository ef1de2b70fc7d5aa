"""`seatrial tune`: a folder whole or not at all, tables people read, bad input in one sentence."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.control.loop_files import AUTOPILOT, FIN, model_file, nomoto, write_loop_file
from tests.fits import example_fit
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin

from seatrial import api, cli
from seatrial.cli.result_output import print_tuning
from seatrial.control.loopfile.load import tuning_task
from seatrial.core.results.tuning import Tuning
from seatrial.core.values import InputError, Ship
from seatrial.data.folder.gains_file import read_gains
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.data.folder.result_folder import save_result
from seatrial.data.trial import load_trial
from seatrial.physics.loops import margins
from seatrial.physics.models import model_named


@pytest.fixture
def loop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A loop file; the search is replaced by a tuning nobody searched."""
    monkeypatch.setattr("seatrial.api.tune", lambda *_, **__: fabricated_fin())
    return write_loop_file(tmp_path, FIN)


def test_it_writes_six_files_and_prints_what_they_say(
    loop: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    out = tmp_path / "new" / "fins"
    assert run_command("tune", loop, "--out", out, "--json", tmp_path / "t.json") == 0
    names = ["arrays.npz", "gains.toml", "loop.mat", "report.html", "schedule.csv", "tuning.json"]
    assert sorted(p.name for p in out.iterdir()) == names
    tuning = fabricated_fin()
    assert read_gains(out / "gains.toml") == tuning.chosen.gains
    table = json.loads((out / "tuning.json").read_text())
    printed = json.loads((tmp_path / "t.json").read_text())
    assert {key: table[key] for key in ("chosen", "front", "schedule", "bounds", "findings")} == {
        key: printed[key] for key in ("chosen", "front", "schedule", "bounds", "findings")
    }
    assert table["chosen"]["gains"] == tuning.chosen.gains
    said = capsys.readouterr().out
    assert all(reason in said for reason in tuning.reasons)
    rows = {line.strip().partition("  ")[0]: line.split()[-3:] for line in said.splitlines()}
    assert rows["reduction, %"][0] == "74.0" and rows["roll angle, deg"][0] == "2.10"
    assert "least roll violates the constraints: " in said and "18 conditions" in said
    assert f"gains: {out / 'gains.toml'}" in said


def test_without_a_folder_it_only_prints(
    loop: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    before = sorted(tmp_path.iterdir())
    assert run_command("tune", loop) == 0
    assert "  KP 19.4" in capsys.readouterr().out
    assert sorted(tmp_path.iterdir()) == before


def test_an_autopilot_has_no_schedule_to_write_and_says_what_it_turns(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    tuning = fabricated_autopilot()
    api.save(tuning, tmp_path)
    assert not (tmp_path / "schedule.csv").exists()
    print_tuning(tuning)
    said = capsys.readouterr().out
    assert "  heading, deg" in said and "Of 100 ships that the fit allows 100 are stable" in said
    assert "does not settle" in said
    assert "reduction" not in said, "a heading drifts without control; it has no reduction"


def test_a_speed_is_stated_in_its_own_units(capsys: pytest.CaptureFixture) -> None:
    print_tuning(replace(fabricated_bare(), output="u", actuator="v_j"))
    said = capsys.readouterr().out
    assert all(f"\n  {label}" in said for label in ("surge velocity, m/s", "jet velocity, m/s", "its rate, m/s/s"))


def test_what_was_not_examined_is_not_printed(capsys: pytest.CaptureFixture) -> None:
    print_tuning(fabricated_bare())
    said = capsys.readouterr().out
    assert not any(word in said for word in ("schedule", "simulated", "bound", "nan\n", "warning", "stable for"))


def test_margins_that_nothing_limits_are_said_so(capsys: pytest.CaptureFixture) -> None:
    tuning = fabricated_fin()
    free = replace(tuning.chosen, gain_margin=np.inf, phase_margin=np.inf, delay_margin=np.inf)
    print_tuning(replace(tuning, chosen=free))
    assert "gain margin unlimited, phase margin unlimited, delay margin unlimited" in capsys.readouterr().out


def test_a_search_that_refuses_leaves_nothing_behind(
    loop: Path,
    tmp_path: Path,
    run_command: Callable[..., int],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    def refused(*_: object, **__: object) -> Tuning:
        raise InputError("no gains keep the limits: Ms by 12 %; raise that limit")

    monkeypatch.setattr("seatrial.api.tune", refused)
    assert run_command("tune", loop, "--out", tmp_path / "fins") == 2
    assert capsys.readouterr().err.endswith("seatrial: no gains keep the limits: Ms by 12 %; raise that limit\n")
    assert not (tmp_path / "fins").exists()


def test_an_interruption_leaves_nothing_behind(
    loop: Path, tmp_path: Path, run_command: Callable[..., int], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> Tuning:
        raise KeyboardInterrupt

    monkeypatch.setattr("seatrial.api.tune", interrupted)
    assert run_command("tune", loop, "--out", tmp_path / "fins") == cli.INTERRUPT_EXIT_CODE
    assert not (tmp_path / "fins").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("absent.toml",), "loop file 'absent.toml' cannot be read"),
        (
            ("loop.toml", "--from", "absent.toml"),
            "plant: there is no 'model' that a model file could take the place of",
        ),
        (("loop.toml", "--model", "absent.py"), "absent.py"),
        (("loop.toml", "--json", "."), "is a folder; name a file"),
    ],
)
def test_bad_input_is_one_line_and_code_two(
    loop: Path, tmp_path: Path, run_command: Callable[..., int], monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture, arguments: tuple[str, ...], says: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(loop.parent)
    code = run_command("tune", *arguments, "--out", tmp_path / "fins")
    said = capsys.readouterr().err
    assert (code, says in " ".join(said.split()), said.strip().count("\n")) == (2, True, 0)
    assert not (tmp_path / "fins").exists()


def test_the_ship_can_be_named_on_the_command_line(tmp_path: Path) -> None:
    known = model_file(tmp_path, nomoto(), "known.toml")
    path = write_loop_file(tmp_path, AUTOPILOT, ("model.toml", "no such place/model.toml"))
    task = api.load_loop(path, model_file=known)
    assert task.U == 7.0 and task.trimmed_ship is not None


def test_the_example_asks_for_a_schedule_over_27_conditions(repository: Path) -> None:
    task = tuning_task(repository / "examples" / "fin_stabiliser.toml")
    assert task.schedule_grid is not None
    assert len(task.schedule_grid.speeds) * len(task.schedule_grid.headings) * len(task.schedule_grid.heights) == 27
    assert task.baselines["as published"] == {"KP": 11.053, "KI": 0.428, "KD": 32.736}


def test_from_a_decay_record_to_a_model_to_a_loop(repository: Path, tmp_path: Path) -> None:
    """Two commands: what identify writes is what tune reads."""
    examples = repository / "examples"
    fit = example_fit("fin_decay")
    free = [c for c in fit.coefficients if not c.fixed and c.truth]
    assert len(free) == 4
    assert all(abs(c.estimate - c.truth) < 3.5 * c.standard_error for c in free)  # type: ignore[operator]
    known = save_result(fit, tmp_path) / "model.toml"
    task = api.load_loop(examples / "fin_from_decay.toml", model_file=known)
    assert task.trimmed_ship is not None and len(task.trimmed_ship.covariance) == 5
    assert task.loop.plant.gain == pytest.approx(0.256, rel=0.01)


def test_the_autopilots_of_the_examples_turn_their_ships(repository: Path, tmp_path: Path) -> None:
    """On the ship the waterjet's trials were simulated with, and on KVLCC2 as published."""
    jet = ModelFile(model_named("waterjet"), ship=Ship("craft", {"L": 9.8}), approach={"u": 0.8, "v_j": 1.866})
    tanker = load_trial(repository / "examples" / "kvlcc2_design.toml")
    ships = {"waterjet": jet, "kvlcc2": ModelFile(tanker.model, ship=tanker.ship, approach={"u": 1.18, "n": 10.4})}
    for name, file in ships.items():
        known = tmp_path / f"{name}.toml"
        write_model(file, known)
        task = api.load_loop(repository / "examples" / f"{name}_autopilot.toml", model_file=known)
        assert task.demand is not None and task.demand.overshoot == 0.02 and task.constraints.Ms == 1.7
        assert margins(task.loop).is_stable


def test_a_method_is_front_or_genetic(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    path = write_loop_file(tmp_path, FIN)
    assert run_command("tune", path, "--method", "genetics") == 2
    assert "there is no tuning method 'genetics'; did you mean 'genetic'?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("population = 3", "genetic.population"),
        ("mutation = 2.0", "genetic.mutation"),
        ("bits = 60", "genetic.bits"),
        ('objectives = "print"', "genetic.objectives"),
        ("rates = 1", "genetic.rates"),
    ],
)
def test_settings_of_the_search_are_checked(tmp_path: Path, line: str, says: str) -> None:
    path = write_loop_file(tmp_path, f"{FIN}\n[genetic]\n{line}\n")
    with pytest.raises(InputError, match=says) as refused:
        api.load_loop(path)
    assert "\n" not in str(refused.value)


def test_settings_of_the_search_reach_the_task(tmp_path: Path) -> None:
    path = write_loop_file(tmp_path, f'{FIN}\n[genetic]\npopulation = 30\nobjectives = "one-sided"\n')
    genetic = api.load_loop(path).genetic
    assert (genetic.population, genetic.objectives, genetic.generations) == (30, "one-sided", 200)
