"""A track tuned: margins by python-control, no better guidance on a grid, simulated as predicted, at a corner."""

import math
from dataclasses import replace
from pathlib import Path

import control
import numpy as np
import pytest
from tests.control.track.track_cases import track_task_of

from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.task import TrackDemand, TuningTask
from seatrial.control.track.paths import CornerTrial
from seatrial.control.track.tune_track import (
    TrackTrial,
    heading_loop_of,
    line_of_sight,
    track_disturbances,
    track_task,
    tune_track,
)
from seatrial.core.results.tuning import TrackKeeping
from seatrial.core.values import InputError
from seatrial.physics.loops import discrete as python_control
from seatrial.physics.simulate.closed_loop import ActuatorLimits
from seatrial.physics.simulate.craft_control import LineOfSight


@pytest.fixture(scope="module")
def task(tmp_path_factory: pytest.TempPathFactory) -> TuningTask:
    return track_task_of(tmp_path_factory.mktemp("track"))


@pytest.fixture(scope="module")
def demand(task: TuningTask) -> TrackDemand:
    assert task.track is not None
    return task.track


@pytest.fixture(scope="module")
def made(task: TuningTask, demand: TrackDemand) -> TrackKeeping:
    return tune_track(task, demand, task.loop, task.loop.gain_values, 0, lambda _: None, draws=0)


def test_margins_are_those_of_python_control(made: TrackKeeping, task: TuningTask) -> None:
    """The heading loop closed by its feedback, the guidance as a transfer function."""
    heading = heading_loop_of(task, task.loop)
    K = python_control.controller_transfer_function(task.loop.continuous)
    rudder_to_y = control.tf(list(heading.rudder.track.num), list(heading.rudder.track.den))
    rudder_to_psi = control.tf(list(heading.rudder.heading.num), list(heading.rudder.heading.den))
    ordered = control.feedback(K, rudder_to_psi)
    guidance = control.tf([1.0 / made.lookahead, made.integral_gain / made.lookahead**2], [1.0, 0.0])
    open_loop = control.minreal(ordered * rudder_to_y * guidance, verbose=False)
    gain, phase, *_ = control.margin(open_loop)
    assert made.gain_margin == pytest.approx(gain, rel=1e-3)
    assert math.degrees(made.phase_margin) == pytest.approx(phase, abs=0.05)
    assert made.Ms <= task.constraints.Ms + 1e-3


def test_no_guidance_on_a_grid_leaves_less_of_the_distance(
    made: TrackKeeping, task: TuningTask, demand: TrackDemand
) -> None:
    outer = track_task(task, heading_loop_of(task, task.loop), demand)
    delta, sigma = np.meshgrid(np.geomspace(5.0, 500.0, 80), np.linspace(0.0, task.U - 2.0 * demand.current, 40))
    grid = np.column_stack([1.0 / delta.ravel(), (sigma / delta**2).ravel()])
    own = np.array([[1.0 / made.lookahead, made.integral_gain / made.lookahead**2]])
    judged, chosen = (gain_evaluator(outer).evaluate(gains) for gains in (grid, own))
    assert chosen.is_feasible[0]
    assert chosen.objectives[0, 0] <= 1.001 * judged.objectives[judged.is_feasible, 0].min()


def test_simulations_without_limits_have_the_predicted_rms(made: TrackKeeping, task: TuningTask) -> None:
    assert [one.disturbance for one in made.disturbances][1:] != []
    assert len(made.disturbances) == 1 + len(task.disturbances)
    for one in made.disturbances:
        for name in ("output", "actuator", "actuator_rate"):
            off = abs(one.unlimited[name] - one.predicted[name])
            allowed = 5.0 * one.standard_error["output"] * one.unlimited[name] / one.unlimited["output"]
            assert off < allowed + 0.03 * one.predicted[name], (one.disturbance, name)


def test_tight_limits_cost_distance(task: TuningTask, demand: TrackDemand, made: TrackKeeping) -> None:
    heading = heading_loop_of(task, task.loop)
    gains = 1.0 / made.lookahead, made.integral_gain / made.lookahead**2
    outer = track_task(task, heading, demand).loop.with_gains(np.array(gains))
    tight = ActuatorLimits(math.radians(0.5), math.radians(0.2))
    trial = TrackTrial(heading, outer, line_of_sight(gains, made.order_rate), tight)
    current = trial.simulate(track_disturbances(task, heading, demand)[0], seed=0)
    assert current.limited["output"] > 1.05 * current.unlimited["output"]
    assert current.limited["actuator"] <= tight.limit


def test_a_corner_to_port_is_overshot_alike(task: TuningTask, demand: TrackDemand, made: TrackKeeping) -> None:
    heading = heading_loop_of(task, task.loop)
    gains = 1.0 / made.lookahead, made.integral_gain / made.lookahead**2
    outer = track_task(task, heading, demand).loop.with_gains(np.array(gains))
    limits = ActuatorLimits(task.constraints.limit, task.constraints.rate)
    guidance = line_of_sight(gains, made.order_rate)
    port = CornerTrial(heading, guidance, limits, replace(demand, turn=-demand.turn), task.U).respond(outer, 0, 0)
    assert made.corner.overshoot > 0.0
    assert port.overshoot == pytest.approx(made.corner.overshoot, rel=0.02)
    assert abs(made.corner.record["cross_track_error"][-1]) < 0.05 * made.corner.overshoot
    assert made.corner.draws == 0
    assert math.isnan(made.corner.worst_overshoot)


def test_craft_of_a_wide_fit_are_counted(task: TuningTask, demand: TrackDemand) -> None:
    assert task.trimmed_ship is not None
    free = task.trimmed_ship.model.parameters.free
    ship = replace(task.trimmed_ship, covariance=np.diag([(0.03 * p.value) ** 2 for p in free]))
    wide = replace(task, trimmed_ship=ship)
    found = tune_track(wide, demand, task.loop, task.loop.gain_values, 0, lambda _: None, draws=8).corner
    assert found.draws == 8
    assert 0 < found.stable_draws <= 8
    assert found.worst_overshoot > 0.0


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([("value = 0.1,", "value = 0.5,")], "no track can be kept in it"),
        ([("bandwidth = 0.002", "bandwidth = 0.002\ncorner = 3")], "give one up to 120 degrees"),
        (
            [("bandwidth = 0.002", 'bandwidth = 0.02\ncorner = { value = 0, unit = "deg" }')],
            "track.corner: 0 is not positive",
        ),
    ],
)
def test_what_cannot_be_kept_is_refused(tmp_path: Path, changes: list[tuple[str, str]], says: str) -> None:
    with pytest.raises(InputError, match=says):
        made = track_task_of(tmp_path, *changes)
        assert made.track is not None
        tune_track(made, made.track, made.loop, made.loop.gain_values, 0, lambda _: None, draws=0)


def test_a_plant_without_a_model_keeps_no_track(task: TuningTask, demand: TrackDemand) -> None:
    with pytest.raises(InputError, match="identified model with heading and position"):
        tune_track(replace(task, trimmed_ship=None), demand, task.loop, task.loop.gain_values, 0, lambda _: None)


def test_a_track_is_kept_where_the_craft_settles(task: TuningTask, demand: TrackDemand, made: TrackKeeping) -> None:
    assert made.corner.is_kept
    heading, limits = heading_loop_of(task, task.loop), ActuatorLimits(task.constraints.limit, task.constraints.rate)
    hasty = CornerTrial(heading, LineOfSight(1.0, 0.0, 0.1 * made.order_rate), limits, demand, task.U)
    assert not hasty.settles()
