"""Demands carried out: against python-control where all is linear, against closed forms where ships are drawn."""

import math
from dataclasses import replace

import control
import numpy as np
import pytest

from seatrial.control.controller import (
    reference_model,
    relative_overshoot,
    settling_time,
    shortfall,
    simulate_manoeuvres,
    simulate_tracking,
)
from seatrial.control.ship import draw_parameters, plant_and_disturbance, plant_as_model, stable_draws, trim_ship
from seatrial.control.task import Demand, SlowDisturbance, TrimmedShip, TuningTask
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.loops import Block, LoopSignal, Sampling, TransferLoop
from seatrial.physics.loops.autopilot import acceleration_feed_forward, heading_loop, pitch_loop, speed_loop
from seatrial.physics.loops.discrete import open_loop_transfer_function
from seatrial.physics.loops.objective import variance
from seatrial.physics.models import model_named
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.simulate.closed_loop import REFERENCE, ActuatorLimits

DEGREE = math.pi / 180.0
GEAR = (Block("steering gear", (1.0,), (0.5, 1.0)),)


def sampled(loop: TransferLoop) -> TransferLoop:
    """The loop as it runs in time, nearly that in continuous time."""
    return replace(loop, sampling=Sampling(0.01))


def task_of(
    loop: TransferLoop, ship: TrimmedShip | None, demand: Demand | None, restriction: ControllerConstraints
) -> TuningTask:
    objectives = variance("output", "rad^2", LoopSignal.OUTPUT), variance("rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1)
    return TuningTask(
        "",
        "autopilot",
        "",
        loop,
        (SlowDisturbance(0.03, 0.05, 1.0),),
        objectives,
        restriction,
        1.0,
        trimmed_ship=ship,
        demand=demand,
    )


def nomoto(K: float = 0.2, T: float = 8.0, sd: tuple[float, float] = (0.0, 0.0)) -> TrimmedShip:
    model = model_named("nomoto").with_values({"K": K, "T": T})
    covariance = np.diag(np.square(sd)) if any(sd) else np.empty((0, 0))
    return trim_ship(ModelFile(model, covariance), output="psi", actuator="delta")


def autopilot(ship: TrimmedShip, *parts: str) -> TransferLoop:
    plant, disturbance = plant_and_disturbance(ship)
    return sampled(heading_loop(plant, disturbance, GEAR, parts=parts or ("KP", "KD")))


def test_the_reference_model_is_critically_damped() -> None:
    dt, T = 0.05, 6.0
    time = dt * np.arange(2000)
    made = reference_model(np.ones(2000), dt, T).level
    assert made == pytest.approx(1.0 - (1.0 + time / T) * np.exp(-time / T), abs=1e-12)


def test_the_reference_keeps_its_rate_and_arrives() -> None:
    dt, T, rate = 0.05, 2.0, 0.02
    made = reference_model(np.full(2000, 0.5), dt, T, rate).level
    assert np.diff(made).max() == pytest.approx(rate * dt, rel=1e-9)
    assert np.diff(made).min() >= 0.0
    assert made[-1] == pytest.approx(0.5, abs=1e-9)


def test_overshoot_and_settling_are_of_the_change() -> None:
    demand = np.concatenate([[0.0], np.full(100, 2.0), np.full(100, -2.0)])
    output = demand.copy()
    output[10], output[130] = 2.1, -2.6
    assert relative_overshoot(output, demand, (1,)) == pytest.approx(0.05)
    assert relative_overshoot(output, demand, (1, 101)) == pytest.approx(0.15)
    assert settling_time(output, demand, (1, 101), 0.5) == pytest.approx(15.0)
    assert math.isnan(settling_time(np.zeros(201), demand, (1, 101), 0.5))
    assert relative_overshoot(-output, -demand, (1, 101)) == pytest.approx(0.15)


@pytest.mark.parametrize("known", [True, False])
def test_without_limits_a_linear_ship_follows_as_python_control_says(*, known: bool) -> None:
    ship = nomoto()
    loop = autopilot(ship, "KP", "KI", "KD")
    if not known:
        ship = plant_as_model(loop)
    loop, every = replace(loop, sampling=Sampling(0.2)), 20
    reference = reference_model(np.full(300, 0.3), 0.2, 5.0).level
    held = np.repeat(reference, every)
    output, _ = simulate_tracking(ship, loop, loop.gain_values, ActuatorLimits(), 0.2 / every, held)
    closed = control.feedback(open_loop_transfer_function(loop), 1)
    assert output[::every] == pytest.approx(control.forced_response(closed, inputs=reference).outputs, abs=1e-5)


def test_the_reference_has_the_velocity_and_acceleration_of_its_level() -> None:
    dt, T = 0.01, 6.0
    motion = reference_model(np.full(4000, 0.3), dt, T, rate=0.012)
    assert np.gradient(motion.level, dt)[5:-5] == pytest.approx(motion.velocity[5:-5], abs=2e-5)
    swift = reference_model(np.full(4000, 0.3), dt, T)
    assert np.gradient(swift.velocity, dt)[5:-5] == pytest.approx(swift.acceleration[5:-5], abs=2e-5)


def test_fed_forward_a_nomoto_ship_follows_without_error_whatever_the_gains() -> None:
    """(T r' + r) / K is the inverse of the ship: what is left is the steering gear's lag and the step's."""
    ship, dt = nomoto(), 0.01
    loop = sampled(heading_loop(*plant_and_disturbance(ship), ()))
    motion = reference_model(np.full(6000, 0.3), dt, 12.0)
    law = acceleration_feed_forward(loop.plant, 1.0 / 12.0)
    assert (law.level, law.velocity, law.acceleration) == pytest.approx((0.0, 5.0, 40.0), rel=1e-9)
    for share in (1.0, 0.1):
        fed, alone = (
            simulate_tracking(ship, loop, share * loop.gain_values, ActuatorLimits(), dt, motion.level, forward)[0]
            for forward in (motion.fed_forward(law), None)
        )
        assert np.abs(fed - motion.level).max() < 4e-4
        assert np.abs(alone - motion.level).max() > 0.01


def test_a_speed_is_fed_forward_by_its_level() -> None:
    plant = Block("speed", (0.5,), (20.0, 1.0))
    law = acceleration_feed_forward(plant, 0.1)
    assert (law.level, law.velocity, law.acceleration) == pytest.approx((2.0, 40.0, 0.0), rel=1e-9)


def test_settling_counts() -> None:
    ship = nomoto()
    task = task_of(autopilot(ship), ship, Demand(20.0 * DEGREE, 0.5, 10.0, 300.0), ControllerConstraints())
    assert shortfall(task, task.loop, task.loop.gain_values) == (0.0, "")
    hasty = replace(task, demand=Demand(20.0 * DEGREE, 0.5, 10.0, 300.0, settling=20.0))
    far, why = shortfall(hasty, hasty.loop, hasty.loop.gain_values)
    assert far >= 1.0 and "s to settle within 5 %" in why


def test_a_step_is_followed_within_the_actuators_limits() -> None:
    ship = nomoto()
    loop, dt = autopilot(ship), 0.01
    limits = ActuatorLimits(5.0 * DEGREE, 2.0 * DEGREE)
    output, rudder = simulate_tracking(ship, loop, loop.gain_values, limits, dt, np.full(12_000, 0.7))
    assert np.abs(rudder).max() == pytest.approx(5.0 * DEGREE, rel=1e-9)
    assert np.abs(np.diff(rudder)).max() == pytest.approx(2.0 * DEGREE * dt, rel=1e-9)
    assert output[-1] == pytest.approx(0.7, rel=0.01)


def test_the_reference_asks_no_more_than_the_actuator_can_do() -> None:
    ship = nomoto()
    loop = autopilot(ship)
    limits = ControllerConstraints(2.0, 0.2, 0.2, limit=5.0 * DEGREE, rate=2.0 * DEGREE)
    task = task_of(loop, ship, Demand(40.0 * DEGREE, 0.02, 2.0, 240.0), limits)
    change, zigzag = simulate_manoeuvres(task, loop, "chosen", loop.gain_values, 0, draws=0)
    assert (change.name, zigzag.name, change.controller) == ("course change", "zigzag", "chosen")
    for made in (change, zigzag):
        assert np.abs(made.record["delta"]).max() < 5.0 * DEGREE
        assert made.overshoot < 0.05
        assert made.draws == made.stable_draws == 0
        assert math.isnan(made.worst_overshoot)
        assert made.sampled_outputs.shape[0] == 0
        assert len(made.record) <= 1001
    free = replace(task, constraints=ControllerConstraints())
    assert (
        np.abs(simulate_manoeuvres(free, loop, "", loop.gain_values, 0, draws=0)[0].record["delta"]).max()
        > 5.0 * DEGREE
    )
    assert change.record[REFERENCE][-1] == pytest.approx(40.0 * DEGREE, rel=1e-6)
    assert change.record["psi"][-1] == pytest.approx(40.0 * DEGREE, rel=0.01)
    assert np.sign(zigzag.record["demand"][[200, 400, 600, 800]]).tolist() == [1.0, -1.0, 1.0, -1.0]


def test_ships_that_no_gain_turns_the_other_way_for_are_counted_unstable() -> None:
    ship = nomoto(sd=(0.12, 0.01))
    loop = autopilot(ship)
    task = task_of(loop, ship, Demand(0.3, 0.02, 10.0, 120.0), ControllerConstraints(limit=0.6))
    made = draw_parameters(ship, 100)
    K = np.array([one.model.parameters["K"].value for one in made.ships])
    assert 0 < (K < 0.0).sum() < 20
    assert stable_draws(task, loop.gain_values) == (int((K > 0.0).sum()), 100)
    change, _ = simulate_manoeuvres(task, loop, "chosen", loop.gain_values, 0)
    assert (change.stable_draws, change.draws) == stable_draws(task, loop.gain_values)
    assert change.sampled_outputs.shape == (20, len(change.record))
    assert change.worst_overshoot == math.inf


def test_stability_of_draws_is_that_of_their_closed_poles() -> None:
    file = ModelFile(kvlcc2(), np.diag(np.square(_spread())), approach={"n": 10.23})
    ship = trim_ship(file, output="psi", actuator="delta")
    loop = autopilot(ship)
    made = draw_parameters(ship, 40)
    slow = 0.02 * loop.gain_values
    expected = [
        all(replace(loop, plant=p).with_gains(slow).closed_loop_poles.real.max() < 0.0 for p in plants)
        for plants in made.plants
    ]
    assert 0 < sum(expected) < 40
    assert list(made.stable_ships(loop, slow)) == expected
    assert sum(made.stable_ships(loop, loop.gain_values)) > sum(expected)


def _spread() -> list[float]:
    return [0.03 if p.name in ("N_v", "Y_v", "N_r") else 1e-6 for p in kvlcc2().parameters.free]


def test_ships_without_a_steady_speed_are_lost_and_unstable() -> None:
    model = model_named("waterjet")
    sd = [0.03 if p.name == "X_uu" else 0.0 for p in model.parameters.free]
    file = ModelFile(model, np.diag(np.square(sd)), approach={"v_j": 1.866})
    ship = trim_ship(file, output="psi", actuator="delta")
    made, loop = draw_parameters(ship, 60), autopilot(ship)
    untrimmed = made.draws - len(made.ships)
    assert untrimmed > 0
    task = task_of(loop, ship, Demand(0.3, 0.02, 20.0, 300.0), ControllerConstraints(limit=0.5))
    change, _ = simulate_manoeuvres(task, loop, "chosen", loop.gain_values, 0, draws=60)
    assert change.draws == 60
    assert change.stable_draws <= 60 - untrimmed
    assert change.worst_overshoot == math.inf


def test_the_same_seed_draws_the_same_ships() -> None:
    ship = nomoto(sd=(0.02, 0.5))
    first, again, other = (draw_parameters(nomoto(sd=(0.02, 0.5)), 5, seed) for seed in (0, 0, 1))
    assert [p[0].num for p in first.plants] == [p[0].num for p in again.plants]
    assert [p[0].num for p in first.plants] != [p[0].num for p in other.plants]
    assert draw_parameters(replace(ship, covariance=np.empty((0, 0)))).draws == 0


def test_speed_and_pitch_follow_a_demand() -> None:
    craft = ModelFile(model_named("waterjet"), approach={"v_j": 1.866})
    ship = trim_ship(craft, output="u", actuator="v_j")
    plant, disturbance = plant_and_disturbance(ship)
    loop = sampled(speed_loop(plant, disturbance, (Block("steering gear", (1.0,), (1.0, 1.0)),), actuator="v_j"))
    task = task_of(loop, ship, Demand(0.2, 0.02, 20.0, 400.0), ControllerConstraints(limit=1.0, rate=0.2))
    change, _ = simulate_manoeuvres(task, loop, "chosen", loop.gain_values, 0)
    assert change.name == "speed change"
    assert change.record["u"][[0, -1]] == pytest.approx([ship.state[0], ship.state[0] + 0.2], abs=2e-3)
    hull = {"m": 3000.0, "I5": 9000.0, "c33": 8e4, "c55": 2.5e5, "c35": 0.0, "c53": 0.0, "lift_1": 5e4, "x_f1": 3.0}
    added = {"a33": 2500.0, "a55": 7000.0, "a35": 0.0, "a53": 0.0, "b33": 9e3, "b55": 2.4e4, "b35": 0.0, "b53": 0.0}
    boat = trim_ship(ModelFile(model_named("heave_pitch").with_values(hull | added)), output="theta",
                  actuator="delta_f1", disturbance="M5")  # fmt: skip
    fins = sampled(pitch_loop(*plant_and_disturbance(boat), (Block("servo", (1.0,), (0.05, 1.0)),)))
    fins = fins.with_gains(np.array([0.5, 2.0, 1.0]) * [1.0, fins.gains["KI"].upper / 4.0, fins.gains["KD"].value])
    made, _ = simulate_manoeuvres(
        task_of(fins, boat, Demand(0.02, 0.05, 2.0, 60.0), ControllerConstraints()), fins, "x", fins.gain_values, 0
    )
    assert made.name == "change of theta"
    assert made.record["theta"][-1] == pytest.approx(0.02, rel=0.01)


def test_a_task_without_a_demand_is_refused() -> None:
    loop = autopilot(nomoto())
    with pytest.raises(InputError, match="follows no demand"):
        simulate_manoeuvres(task_of(loop, nomoto(), None, ControllerConstraints()), loop, "chosen", loop.gain_values, 0)
