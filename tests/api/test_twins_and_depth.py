"""Ships with two screws, craft with two nozzles, ships in shallow water: all that takes a ship takes these as it is."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.control.loop_files import AUTOPILOT, write_loop_file

import seatrial as st
from seatrial import api
from seatrial.control.front import Effort
from seatrial.control.loopfile.load import tuning_task
from seatrial.control.tune import tune
from seatrial.core.equations import Model
from seatrial.core.values import Ship
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.data.trial import load_trial
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.estimation.design.design import design
from seatrial.estimation.design.task import DesignTask
from seatrial.onboard.follow import follow
from seatrial.physics.models.waterjet import waterjet_twin
from seatrial.problems.twin_ships import shallow_water_ship, twin_screw_ship

SHIPS: dict[str, tuple[Callable[[], Model], dict[str, float], str]] = {
    "mmg_twin": (twin_screw_ship, {"u": 1.5, "n": 9.0}, "n_difference"),
    "mmg_shallow": (shallow_water_ship, {"u": 1.18, "n": 10.4, "depth": 0.69}, "depth"),
    "waterjet_twin": (waterjet_twin, {"u": 0.8, "v_j": 1.866}, "bucket_difference"),
}
"""Model -> it, a straight run, and the input that is its own."""


@pytest.fixture(params=sorted(SHIPS))
def ship(request: pytest.FixtureRequest) -> ModelFile:
    make, approach, _ = SHIPS[request.param]
    model = make()
    return ModelFile(model, ship=Ship("a ship", {"L": model.parameters["L"].value}), approach=approach)


def own_input(ship: ModelFile) -> str:
    """The input that no other model has."""
    return SHIPS[ship.model.name][2]


def test_a_zigzag_is_steered_and_the_own_input_acts(ship: ModelFile) -> None:
    held = {name: value for name, value in ship.approach.items() if name in ("n", "v_j")}
    plain, other = (api.simulate(ship, "zigzag:10/10", inputs=held | more) for more in ({}, {own_input(ship): 0.6}))
    assert np.ptp(plain["psi"]) > math.radians(15.0)
    assert np.max(np.abs(plain["psi"][:100] - other["psi"][:100])) > 1e-4


@pytest.mark.parametrize(("target", "name"), [("c99", "ship"), ("matlab", "ship"), ("casadi", "ship.py")])
def test_it_is_exported(ship: ModelFile, target: str, name: str, tmp_path: Path) -> None:
    st.export(ship, target, tmp_path / name)
    written = "\n".join(path.read_text() for path in tmp_path.rglob("*") if path.suffix in (".c", ".m", ".py"))
    assert own_input(ship) in written


def test_an_autopilot_is_tuned(ship: ModelFile, tmp_path: Path) -> None:
    write_model(ship, tmp_path / "model.toml")
    made = tune(
        tuning_task(write_loop_file(tmp_path, AUTOPILOT)),
        effort=Effort(refined=2, fill_rounds=1, neighbours=200),
    )
    assert made.chosen.Ms < 2.5


def test_a_manoeuvre_with_its_own_input_is_designed(ship: ModelFile) -> None:
    model, name = ship.model, own_input(ship)
    model = model.with_parameters(model.parameters.only_free(("Y_v", "N_v", "N_r")))
    ranges = {"n_difference": (-4.0, 4.0, "rps"), "depth": (0.6, 1.0, "m"), "bucket_difference": (-1.0, 1.0, "1")}
    lower, upper, unit = ranges[name]
    rudder = InputRange(lower=-0.5, upper=0.5, unit="rad", rate=0.1, hold=15.0)
    request = DesignRequest(
        duration=90.0, rate=2.0, draws=2, held={n: v for n, v in ship.approach.items() if n in ("n", "v_j")},
        inputs={"delta": rudder, name: InputRange(lower=lower, upper=upper, unit=unit, rate=1.0, hold=15.0)},
    )  # fmt: skip
    sensors = {"u": 0.02, "v": 0.02, "r": 0.002, "psi": 0.003}
    task = DesignTask("how?", Ship("a ship", {"L": 6.0}), model, sensors, request)
    made = design(task, 0, confirmation_runs=0, generations=2)
    assert name in made.plan.channels


@pytest.mark.long(every=3)
def test_it_is_followed(ship: ModelFile, tmp_path: Path) -> None:
    held = {name: value for name, value in ship.approach.items() if name in ("n", "v_j", "depth")}
    run = api.simulate(ship, "zigzag:20/20", inputs=held)
    names = ("psi", "u", "v", "r", *ship.model.input_names)
    names = tuple(name for name in names if name in run.channels and not name.startswith("wind"))
    table = np.column_stack([run.time, *(run[name] for name in names)])[:600:5]
    np.savetxt(tmp_path / "run.csv", table, "%.9g", ",", header=",".join(("t", *names)), comments="")
    units = {name: run.channel(name).unit for name in names}
    channels = "\n".join(f'channels.{name} = {{ column = "{name}", unit = "{units[name]}" }}' for name in names)
    values = {p.name: p.value for p in ship.model.parameters if p.name != "N_r"}
    start = f"N_r = {1.1 * ship.model.parameters['N_r'].value}"
    fixed = "\n".join(f"{name} = {value}" for name, value in values.items() if name != "L")
    (tmp_path / "trial.toml").write_text(
        f'[ship]\nname = "a ship"\nL = {values["L"]}\n[model]\nname = "{ship.model.name}"\n'
        f'free = ["N_r"]\n[model.start]\n{start}\n[model.fixed]\n{fixed}\n'
        f'[follow]\nsource = "file"\nfile = "run.csv"\nrate = 2.0\ntime = {{ column = "t" }}\n{channels}\n'
    )
    outcome = follow(load_trial(tmp_path / "trial.toml"), once=True)
    assert outcome.fit is not None
    found = next(c for c in outcome.fit.coefficients if c.name == "N_r")
    assert found.estimate == pytest.approx(ship.model.parameters["N_r"].value, rel=0.05)
