"""From trials to a course change: identified craft, gains from the front, ships that the fit allows."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from tests.fits import example_fit

from seatrial.control.choice import choose
from seatrial.control.controller import shortfall, simulate_manoeuvres
from seatrial.control.front import Effort, pareto_front
from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.ship import plant_and_disturbance, stable_draws, trim_ship
from seatrial.control.task import Demand, SlowDisturbance, TrimmedShip, TuningTask
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import load_trial
from seatrial.data.trial.trial import Role
from seatrial.estimation.identify import identify
from seatrial.physics.loops import Block, LoopSignal, Sampling, margins
from seatrial.physics.loops.autopilot import heading_loop
from seatrial.physics.loops.discrete import default_sample_time
from seatrial.physics.loops.objective import variance

DEGREE = math.pi / 180.0
OBJECTIVES = (
    variance("output", "rad^2", LoopSignal.OUTPUT),
    variance("actuator rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
)
QUICK = Effort(refined=12, fill_rounds=2, neighbours=4000)


def autopilot_of(ship: TrimmedShip, L: float, gear: float, limit: float, rate: float) -> TuningTask:
    """A 20 degree course change through a reference model of two ship lengths; limits of the rudder in degrees."""
    plant, disturbance = plant_and_disturbance(ship)
    loop = heading_loop(plant, disturbance, (Block("steering gear", (1.0,), (gear, 1.0)),))
    loop = replace(loop, sampling=Sampling(default_sample_time(loop)))
    U = float(ship.state[0])
    demand = Demand(20.0 * DEGREE, 0.02, 2.0 * L / U, 40.0 * L / U)
    limits = ControllerConstraints(Ms=1.7, limit=limit * DEGREE, rate=rate * DEGREE)
    met = (SlowDisturbance(2.0 * DEGREE, 0.3 * U / L, U),)
    return TuningTask("", "autopilot", "", loop, met, OBJECTIVES, limits, U, trimmed_ship=ship, demand=demand)


def demand_is_met(task: TuningTask, L_over_U: float) -> None:
    """Chosen from the front: overshoot, Ms, every ship drawn, settled within ten ship lengths."""
    made = gain_evaluator(task)
    choice = choose(task, ((made, pareto_front(made, "three gains", 0, lambda _: None, QUICK)),), 0, lambda _: None)
    assert margins(task.loop.with_gains(choice.gains)).Ms <= 1.7
    assert shortfall(task, task.loop, choice.gains) == (0.0, "")
    assert stable_draws(task, choice.gains) == (100, 100)
    for manoeuvre in simulate_manoeuvres(task, task.loop, "chosen", choice.gains, 0):
        assert manoeuvre.overshoot <= 0.02
        assert manoeuvre.worst_overshoot <= 0.02
        assert manoeuvre.stable_draws == manoeuvre.draws == 100
        assert manoeuvre.settling < 10.0 * L_over_U


def test_an_identified_waterjet_craft_changes_course() -> None:
    fit = example_fit("waterjet")
    ship = trim_ship(ModelFile(fit.model, fit.covariance, approach={"v_j": 1.866}), output="psi", actuator="delta")
    demand_is_met(autopilot_of(ship, 9.8, gear=0.5, limit=30.0, rate=20.0), 9.8 / float(ship.state[0]))


@pytest.mark.long
def test_an_identified_tanker_unstable_on_its_course_changes_course(
    data_folder: Path, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Four of its zigzags; the gear is the ship's 2.34 deg/s at the model's scale."""
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    trial = load_trial(repository / "examples" / "kvlcc2_hsva.toml")
    runs = [run for run in trial.runs if run.role is Role.TRAIN][::3]
    fit = identify(replace(trial, runs=tuple(runs)))
    ship = trim_ship(ModelFile(fit.model, fit.covariance, approach={"n": 10.23}), output="psi", actuator="delta")
    assert plant_and_disturbance(ship)[0].poles.real.max() > 0.0
    task = autopilot_of(ship, 7.0, gear=0.3, limit=35.0, rate=2.34 * math.sqrt(45.7))
    demand_is_met(task, 7.0 / float(ship.state[0]))


def test_gains_that_hold_nothing_fall_short_in_words() -> None:
    from seatrial.physics.models.published import kvlcc2

    ship = trim_ship(ModelFile(kvlcc2(), approach={"n": 10.23}), output="psi", actuator="delta")
    task = autopilot_of(ship, 7.0, gear=0.3, limit=35.0, rate=15.8)
    lazy, why = shortfall(task, task.loop, 1e-4 * task.loop.gain_values)
    assert lazy >= 1.0
    assert "does not settle" in why
    wild, why = shortfall(task, task.loop, task.loop.gain_values * [6.0, 200.0, 0.1])
    assert wild > 0.0
    assert "overshoots" in why
