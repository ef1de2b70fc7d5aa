"""`seatrial design`: the folder whole or not at all, tables people read, a plan that replays, JSON as documented."""

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.reporting.fabricated_design import fabricated_design

from seatrial import api
from seatrial.core.results import TimedOrder
from seatrial.core.values import InputError, RecordKind, Ship
from seatrial.data.folder.gains_file import orders_csv
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.data.read import read_record_csv
from seatrial.estimation.design.task import design_task
from seatrial.estimation.information.symmetries import refuse_unidentifiable
from seatrial.physics.models import model_named

TRIAL = """
[ship]
name = "craft"
L = 9.8
[model]
name = "waterjet"
[noise]
u = 0.02
[design]
duration = 120
rate = 5
[design.inputs.delta]
lower = -35
upper = 35
unit = "deg"
hold = 6
[design.held]
v_j = 1.866
"""


@pytest.fixture
def trial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A trial file; the search is replaced by a design nobody searched."""
    monkeypatch.setattr("seatrial.api.design", lambda *_, **__: fabricated_design())
    path = tmp_path / "trial.toml"
    path.write_text(TRIAL)
    return path


def test_it_writes_its_files_and_prints_what_they_say(
    trial: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    out = tmp_path / "new" / "plan"
    assert run_command("design", trial, "--out", out, "--json", tmp_path / "d.json") == 0
    assert sorted(p.name for p in out.iterdir()) == [
        "arrays.npz",
        "design.json",
        "model.toml",
        "orders.csv",
        "plan.csv",
        "report.html",
    ]
    said = capsys.readouterr().out.splitlines()
    (head,) = [k for k, line in enumerate(said) if line.strip().startswith("Manoeuvre ")]
    names = ["designed", "prbs", "zigzag", "turning"]
    assert [line.split()[0] for line in said[head + 1 : head + 5]] == names
    assert said[head + 2].endswith("1 ship diverged") and said[head + 4].endswith("leaves the limits")
    assert said[2].startswith("The worst relative standard error is ")
    assert any("rudder or nozzle angle, positive to starboard" in line for line in said)
    assert any(line.split() == ["0:54", "-27", "1:54", "-15"] for line in said), "every order is printed"
    printed, stored = (json.loads(path.read_text()) for path in (tmp_path / "d.json", out / "design.json"))
    assert printed["orders"] == stored["orders"] and printed["designed"].items() <= stored["designed"].items()


def test_the_plan_replays(trial: Path, tmp_path: Path, run_command: Callable[..., int]) -> None:
    model, run_file = tmp_path / "model.toml", tmp_path / "run.csv"
    write_model(ModelFile(model_named("waterjet"), ship=Ship("craft", {"L": 9.8})), model)
    assert run_command("design", trial, "--out", tmp_path / "plan") == 0
    assert run_command("simulate", model, "--inputs", tmp_path / "plan" / "plan.csv", "--out", run_file) == 0
    plan, sailed = read_record_csv(tmp_path / "plan" / "plan.csv"), read_record_csv(run_file)
    assert plan.kind is RecordKind.PLANNED
    assert np.array_equal(sailed["delta"], plan["delta"])
    assert (sailed["v"][0], sailed["r"][0], sailed["psi"][0]) == (0.0, 0.0, 0.0)
    straight = api.simulate(api.load_model(model), "zigzag:20/20", inputs={"v_j": 1.866}, duration=1.0)
    assert sailed["u"][0] == straight["u"][0]


def test_a_plan_starts_at_the_speed_that_is_said() -> None:
    file = ModelFile(model_named("waterjet"), ship=Ship("craft", {"L": 9.8}))
    assert api.replay(file, fabricated_design().plan, 1.25)["u"][0] == 1.25


def test_orders_are_in_people_s_units() -> None:
    design = fabricated_design()
    rows = list(csv.reader(orders_csv(design).splitlines()))
    assert rows[0] == ["time [s]", "delta [deg]"]
    assert [float(cell) for cell in rows[2]] == [6.0, pytest.approx(np.degrees(design.orders[1].values["delta"]))]
    assert orders_csv(replace(design, orders=(TimedOrder(3.0, {}),))).splitlines()[1] == "3,"


def test_json_is_as_documented_and_holds_no_infinity(tmp_path: Path) -> None:
    design = fabricated_design()
    blind = replace(design.designed, relative_error=np.full(11, np.inf))
    api.save(replace(design, designed=blind), tmp_path)
    table = json.loads((tmp_path / "design.json").read_text())
    assert table["designed"]["worst"] is None
    assert table["baselines"][1]["diverged"] == 1 and table["baselines"][1]["sampled_relative_error"][2]["X_uu"] is None
    assert table["orders"][0] == {"time": 0.0, "values": {"delta": pytest.approx(-0.50614548)}}
    assert list(table["designed"]["relative_error"]) == list(design.coefficients)


def test_a_search_that_refuses_leaves_nothing_behind(
    trial: Path,
    tmp_path: Path,
    run_command: Callable[..., int],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    def refused(*_: object, **__: object) -> None:
        raise InputError("design.drift: even a straight run leaves it; allow more")

    monkeypatch.setattr("seatrial.api.design", refused)
    assert run_command("design", trial, "--out", tmp_path / "plan") == 2
    assert capsys.readouterr().err.endswith("seatrial: design.drift: even a straight run leaves it; allow more\n")
    assert not (tmp_path / "plan").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--from", "absent.toml"), "model file 'absent.toml' cannot be read"),
        (("--model", "absent.py"), "absent.py"),
    ],
)
def test_files_that_are_not_there_are_said(
    trial: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture,
    arguments: tuple[str, ...], says: str,
) -> None:  # fmt: skip
    assert run_command("design", trial, "--out", tmp_path / "plan", *arguments) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "plan").exists()


@pytest.mark.parametrize("command", ["check", "identify"])
def test_a_trial_without_records_is_only_designed(
    command: str, trial: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    out = ("--out", tmp_path / "fit") if command == "identify" else ()
    assert run_command(command, trial, *out) == 2
    said = capsys.readouterr().err.strip()
    assert said.endswith("there are no [[records]] to read; add them, or plan a trial with 'seatrial design'")
    assert said.count("\n") == 0


YAWING = """
[ship]
name = "a yawing ship"
L = 100.0
[model]
name = "nomoto"
start = { K = 0.08, T = 12.0 }
[noise]
psi = { sd = 0.5, unit = "deg" }
[design]
duration = 120
rate = 1
draws = 2
[design.inputs.delta]
lower = -20
upper = 20
unit = "deg"
rate = 3
hold = 20
"""


def test_the_search_itself_beats_the_standard_and_repeats_to_the_bit(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    path = tmp_path / "yawing.toml"
    path.write_text(YAWING)
    tables = []
    for name in ("one", "two"):
        assert run_command("design", path, "--out", tmp_path / name, "--seed", "3") == 0
        table = json.loads((tmp_path / name / "design.json").read_text())
        tables.append({key: value for key, value in table.items() if key != "elapsed_s"})
    assert tables[0] == tables[1]
    assert (tmp_path / "one" / "plan.csv").read_bytes() == (tmp_path / "two" / "plan.csv").read_bytes()
    assert tables[0]["designed"]["worst"] < min(rival["worst"] for rival in tables[0]["baselines"])
    assert "standard manoeuvres" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["waterjet", "kvlcc2", "heave_pitch"])
def test_the_examples_ask_for_what_can_be_stated(name: str, repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SEATRIAL_DATA", raising=False)
    task = design_task(api.load_trial(repository / "examples" / f"{name}_design.toml"))
    assert task.request.draws > 0
    assert np.isfinite(task.initial_state).all()
    refuse_unidentifiable(task.model, tuple(task.sensors), ())
