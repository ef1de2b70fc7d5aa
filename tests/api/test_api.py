"""The commands as functions: what each returns, and what it refuses."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from tests.reporting.fabricated import fabricated_fit

import seatrial.api as sea
from seatrial.core.values import InputError, Record, Ship
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.folder.result_folder import model_of_fit
from seatrial.data.trial import Role
from seatrial.physics.models import model_named


def test_the_demo_trial_loads_with_its_truth(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from seatrial.data import example_series

    monkeypatch.setattr(example_series, "demo_series", partial(example_series.demo_series, executes=1))
    trial = sea.load_trial(example_series.write_demo(tmp_path, seed=1))
    assert [run.role for run in trial.runs].count(Role.VALIDATE) == 2
    assert set(trial.truth) == set(trial.model.parameters.free_names)
    assert not [f for f in sea.check(trial) if f.severity == "error"]


def test_the_waterjet_example_stands_alone(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SEATRIAL_DATA", raising=False)
    trial = sea.load_trial(repository / "examples" / "waterjet.toml")
    assert [run.role for run in trial.runs].count(Role.TRAIN) == 1
    assert not [f for f in sea.check(trial) if f.severity == "error"]
    for name, value in trial.truth.items():
        assert trial.model.parameters[name].value == value


def test_a_model_scale_rudder_is_quicker(repository: Path) -> None:
    trial = sea.load_trial(repository / "examples" / "waterjet.toml")
    full = sea.simulate(ModelFile(trial.model, ship=trial.ship), "zigzag:20/20", inputs={"v_j": 1.866})
    small = Ship("model", trial.ship.particulars, "", 25.0)
    quick = sea.simulate(ModelFile(trial.model, ship=small), "zigzag:20/20", inputs={"v_j": 1.866})
    over = [next(t for t, d in zip(r.time, r["delta"], strict=True) if d > 0.34) for r in (full, quick)]
    assert over[0] / over[1] == pytest.approx(5.0, rel=0.1)


def test_measures_need_a_ship(repository: Path) -> None:
    trial = sea.load_trial(repository / "examples" / "waterjet.toml")
    record = sea.simulate(ModelFile(trial.model), "zigzag:20/20", inputs={"v_j": 1.866})
    with pytest.raises(InputError, match=r"no \[ship\]"):
        sea.measures(ModelFile(trial.model), record)
    assert sea.measures(ModelFile(trial.model, ship=trial.ship), record)["overshoot_1_deg"] > 0.0


def test_the_seed_draws_the_random_binary_sequence(repository: Path) -> None:
    trial = sea.load_trial(repository / "examples" / "waterjet.toml")
    file = ModelFile(trial.model, ship=trial.ship)

    def rudder(text: str, seed: int) -> list[float]:
        return sea.simulate(file, text, inputs={"v_j": 1.866}, duration=100.0, seed=seed)["delta"].tolist()

    for text in ("prbs", "prbs:15", "prbs:15:4"):
        assert rudder(text, 1) == rudder(text, 1)
        assert rudder(text, 1) != rudder(text, 2)
    assert rudder("prbs:20:5:1", 2) == rudder("prbs:20:5:1", 3)
    assert rudder("prbs", 0) == rudder("prbs:20", 0)


@pytest.mark.parametrize("rate", [0.0, -0.1, float("nan")])
def test_a_rudder_that_cannot_move_is_refused(rate: float, repository: Path) -> None:
    trial = sea.load_trial(repository / "examples" / "waterjet.toml")
    with pytest.raises(InputError, match=r"rudder rate .* is not positive"):
        sea.simulate(ModelFile(trial.model, ship=trial.ship), "zigzag:20/20", rudder_rate=rate)


@pytest.mark.parametrize("speed", [float("nan"), float("inf")])
@pytest.mark.parametrize("name", ["nomoto", "roll", "waterjet"])
def test_a_speed_that_is_no_number_is_refused_by_models_with_and_without_one(name: str, speed: float) -> None:
    model = model_named(name)
    record = Record.from_arrays("run", np.arange(3.0), {"delta": np.zeros(3)})
    with pytest.raises(InputError, match=r"approach speed (nan|inf) m/s is no finite number"):
        sea.simulate(ModelFile(model), "zigzag:20/20", speed=speed)
    with pytest.raises(InputError, match=r"approach speed (nan|inf) m/s is no finite number"):
        sea.simulate(ModelFile(model), record, speed=speed)


def test_the_readmes_own_model_replaces_the_examples(repository: Path, tmp_path: Path) -> None:
    from seatrial.physics.models import model_from_file

    page = (repository / "README.md").read_text(encoding="utf-8").split("## A model of your own")[1]
    file = tmp_path / "yaw.py"
    file.write_text(page.split("```python\n")[1].split("```")[0], encoding="utf-8")
    trial = sea.load_trial(repository / "examples" / "waterjet.toml", model_from_file(file))
    assert trial.truth == {}
    assert set(trial.model.parameters.free_names) == {"T", "K"}


def test_a_run_of_a_trial_can_be_replayed(repository: Path) -> None:
    trial = sea.load_trial(repository / "examples" / "waterjet.toml")
    name = trial.runs[0].name
    record = sea.prepared_run(trial, name)
    again = sea.replay(ModelFile(trial.model, ship=trial.ship), record)
    assert (again.time == record.time).all()
    with pytest.raises(InputError, match=f"no run 'none'.*{name}"):
        sea.prepared_run(trial, "none")


def test_a_fit_is_simulated_as_its_model_file_is() -> None:
    fit = fabricated_fit()
    record = sea.simulate(fit, "zigzag:20/20", inputs={"v_j": 1.866}, duration=20.0)
    file = model_of_fit(fit)
    again = sea.simulate(file, "zigzag:20/20", inputs={"v_j": 1.866}, duration=20.0)
    assert (record["psi"] == again["psi"]).all() and record["psi"].any()
    assert sea.predict(fit, fit.records[0]).rms == sea.predict(file, fit.records[0]).rms


def test_what_takes_a_trial_takes_its_file(repository: Path) -> None:
    """The file is read, so that what it lacks is named in a sentence."""
    path = repository / "examples" / "fin_decay.toml"
    with pytest.raises(InputError, match="orders cannot be designed for releases"):
        sea.design(path)
    with pytest.raises(InputError, match=r"\[follow\]"):
        sea.follow(str(path))
    assert sea.identify(path).validation


def test_commands_without_a_motion_begin_at_rest() -> None:
    craft, time = model_named("thrusters"), 0.1 * np.arange(100)
    table = Record.from_arrays("table", time, {n: np.full(100, 0.6) for n in ("command_1", "command_2")})
    run = sea.simulate(craft, table)
    assert run["u"][0] == 0.0
    assert run["u"][-1] > 1.0
    assert np.all(np.abs(run["v"]) < 1e-12)
    assert sea.simulate(craft, table, speed=1.0)["u"][0] == 1.0


def test_the_logs_of_a_folder_are_surveyed_like_a_log(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("time,heading\n0,1\n1,2\n2,3\n", encoding="utf-8")
    (one,) = sea.survey_logs(tmp_path).logs
    assert [topic.rows for topic in one.topics] == [topic.rows for topic in sea.survey_log(one.path).topics] == [3]
