"""From trials to a course change: identified craft, gains from the front, ships that the fit allows."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from seatrial.control.assess import judge
from seatrial.control.choose import choose
from seatrial.control.demand import manoeuvres, shortfall
from seatrial.control.front import Effort, front
from seatrial.control.ship.fleet import robust
from seatrial.control.ship.vessel import plant_of, vessel
from seatrial.control.task import Demand, Task, Unrest, Vessel
from seatrial.core.results.tuning import Restriction
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import load_trial
from seatrial.data.trial.trial import Role
from seatrial.estimation.identify import identify
from seatrial.physics.loops import Seen, margins
from seatrial.physics.loops.autopilot import heading_loop, steering_gear
from seatrial.physics.loops.objective import variance

DEGREE = math.pi / 180.0
OBJECTIVES = variance("output", "rad^2", Seen.OUTPUT), variance("actuator rate", "rad^2/s^2", Seen.ACTUATOR, 1)
QUICK = Effort(population=80, generations=20, polished=12, rounds=2, neighbours=4000)


def autopilot_of(ship: Vessel, L: float, gear: float, limit: float, rate: float) -> Task:
    """A 20 degree course change through a reference model of two ship lengths; limits of the rudder in degrees."""
    plant, disturbance = plant_of(ship)
    loop = heading_loop(plant, disturbance, (steering_gear(gear),))
    U = float(ship.state[0])
    demand = Demand(20.0 * DEGREE, 0.02, 2.0 * L / U, 40.0 * L / U)
    limits = Restriction(peak=1.7, limit=limit * DEGREE, rate=rate * DEGREE)
    met = (Unrest(2.0 * DEGREE, 0.3 * U / L, U),)
    return Task("", "autopilot", "", loop, met, OBJECTIVES, limits, U, vessel=ship, demand=demand)


def demand_is_met(task: Task, L_over_U: float) -> None:
    """Chosen from the front: overshoot, Ms, every ship drawn, settled within ten ship lengths."""
    made = judge(task)
    choice = choose(task, ((made, front(made, "three gains", 0, lambda _: None, QUICK)),), 0, lambda _: None)
    assert margins(task.loop.with_gains(choice.gains)).peak <= 1.7
    assert shortfall(task, task.loop, choice.gains) == (0.0, "")
    assert robust(task, choice.gains) == (100, 100)
    for manoeuvre in manoeuvres(task, task.loop, "chosen", choice.gains, 0):
        assert manoeuvre.overshoot <= 0.02
        assert manoeuvre.worst_overshoot <= 0.02
        assert manoeuvre.stable_draws == manoeuvre.draws == 100
        assert manoeuvre.settling < 10.0 * L_over_U


def test_an_identified_waterjet_craft_changes_course(repository: Path) -> None:
    fit = identify(load_trial(repository / "examples" / "waterjet.toml"))
    ship = vessel(
        ModelFile(fit.model, fit.covariance, approach={"v_j": 1.866}), output="psi", actuator="delta"
    )  # fmt: skip
    demand_is_met(autopilot_of(ship, 9.8, gear=0.5, limit=30.0, rate=20.0), 9.8 / float(ship.state[0]))


def test_an_identified_tanker_unstable_on_her_course_changes_course(
    data_folder: Path, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Six of her zigzags; the gear is the ship's 2.34 deg/s at the model's scale."""
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    trial = load_trial(repository / "examples" / "kvlcc2_hsva.toml")
    runs = [run for run in trial.runs if run.role is Role.TRAIN][::2]
    fit = identify(replace(trial, runs=tuple(runs)))
    ship = vessel(ModelFile(fit.model, fit.covariance, approach={"n": 10.23}), output="psi", actuator="delta")
    assert plant_of(ship)[0].poles.real.max() > 0.0
    task = autopilot_of(ship, 7.0, gear=0.3, limit=35.0, rate=2.34 * math.sqrt(45.7))
    demand_is_met(task, 7.0 / float(ship.state[0]))


def test_gains_that_hold_nothing_fall_short_in_words() -> None:
    from seatrial.physics.models.published import kvlcc2

    ship = vessel(ModelFile(kvlcc2(), approach={"n": 10.23}), output="psi", actuator="delta")
    task = autopilot_of(ship, 7.0, gear=0.3, limit=35.0, rate=15.8)
    lazy, why = shortfall(task, task.loop, 1e-4 * task.loop.values)
    assert lazy >= 1.0
    assert "does not settle" in why
    wild, why = shortfall(task, task.loop, task.loop.values * [6.0, 8.0, 0.1])
    assert wild > 0.0
    assert "overshoots" in why
