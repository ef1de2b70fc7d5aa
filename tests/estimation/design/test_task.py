"""What a trial asks of a design reaches the search, with or without its table; what cannot be asked for is refused."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.design.conftest import BOTH, NOZZLE_RANGE, with_inputs, with_limits

from seatrial.core.results import TrialLimits
from seatrial.core.values import InputError, Record, Ship
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import Role, Run, Trial
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.estimation.design.design import design
from seatrial.estimation.design.manoeuvre_information import planned_record, sample_count, simulate_plan
from seatrial.estimation.design.task import DesignTask, design_task, recorded_request
from seatrial.physics.models import model_named


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"rate": 1e-3}, "does not cross its range"),
        ({"hold": 60.0}, "180 s leave no room for 4 orders"),
    ],
)
def test_an_input_that_cannot_be_moved_so_is_refused(craft: DesignTask, change: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        with_inputs(craft, {"delta": replace(NOZZLE_RANGE, **change)}, {"v_j": 1.866})


def test_nothing_to_move_to_measure_or_to_find_is_refused(craft: DesignTask) -> None:
    with pytest.raises(InputError, match=r"'delt' is no input of model 'waterjet'.*delta"):
        with_inputs(craft, {"delt": NOZZLE_RANGE}, {})
    with pytest.raises(InputError, match="needs its sensors' noise"):
        replace(craft, sensors={})
    known = craft.model.with_parameters(craft.model.parameters.only_free(()))
    with pytest.raises(InputError, match="no free coefficient"):
        replace(craft, model=known)


def test_a_sea_room_that_the_straight_run_leaves_is_refused(craft: DesignTask) -> None:
    limits = TrialLimits(sea_room=20.0)
    with pytest.raises(InputError, match="without any order the ship reaches a distance"):
        design(with_limits(craft, limits), confirmation_runs=0, generations=1)


def test_a_sea_room_that_only_turning_keeps_is_kept(craft: DesignTask) -> None:
    """The straight run leaves it, so that a straight run alone proves nothing about it."""
    made = design(with_limits(craft, TrialLimits(sea_room=0.7 * _straight(craft))), confirmation_runs=0, generations=2)
    assert made.designed.distance <= made.limits.sea_room


def _straight(task: DesignTask) -> float:
    return float(task.initial_state[task.model.states.index("u")]) * task.request.duration


def test_a_trial_begins_straight_ahead_where_surge_balances(craft: DesignTask) -> None:
    """Without any order the craft stays at its first speed and on its course."""
    quiet = planned_record(craft, np.tile(craft.neutral_inputs, (sample_count(craft, 0.2), 1)), 0.2)
    sailed = simulate_plan(craft, quiet, "straight")
    assert sailed.channel("u").values[0] > 0.5
    assert np.ptp(sailed.channel("u").values) < 1e-9
    assert not sailed.channel("psi").values.any()


def test_an_input_begins_at_zero_or_in_the_middle_of_its_range(craft: DesignTask) -> None:
    both = with_inputs(craft, BOTH, {})
    assert both.neutral_positions == {"delta": 0.0, "v_j": pytest.approx(1.9)}


NOZZLE = InputRange(lower=-0.6, upper=0.6, unit="rad", rate=0.07, hold=5.0)
REQUEST = DesignRequest(
    duration=300.0, rate=5.0, inputs={"delta": NOZZLE}, held={"v_j": 1.866}, draws=3, prior_percent=20.0
)


def trial(**changes: object) -> Trial:
    noise = {"u": 0.02, "psi": 0.003}
    made = Trial(Ship("craft", {"L": 9.8}), (), model_named("waterjet"), noise=noise, design_request=REQUEST)
    return replace(made, **changes)


def test_the_brief_becomes_a_task() -> None:
    task = design_task(trial(question="how?"))
    assert (
        task.question,
        task.request.duration,
        task.request.rate,
        task.request.draws,
        task.request.relative_spread,
    ) == ("how?", 300.0, 5.0, 3, 0.2)
    assert task.request.actuators == (NOZZLE.actuator("delta"),)
    assert task.sensors == {"u": 0.02, "psi": 0.003}
    assert task.covariance is None
    assert task.initial_state[0] == pytest.approx(0.8, rel=0.01)


def test_a_model_file_takes_the_place_of_the_trial_s_values() -> None:
    model = model_named("waterjet").with_values({"Y_v": -0.25})
    covariance = np.eye(11) * 1e-6
    task = design_task(trial(), ModelFile(model, covariance))
    assert task.model.parameters["Y_v"].value == -0.25
    assert task.covariance is not None and np.array_equal(task.covariance, covariance)
    assert design_task(trial(), ModelFile(model)).covariance is None


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"design_request": None}, r"there is no table \[design\]"),
        ({"noise": {}}, r"give \[noise\]"),
        ({"noise": {"thrust": 1.0}}, r"\[noise\] thrust is nothing that model 'waterjet' shows"),
        ({"design_request": replace(REQUEST, held={})}, "needs the input 'v_j'"),
        ({"model": model_named("waterjet").with_values({"X_rr": 0.0})}, "coefficient 'X_rr' is zero"),
    ],
)
def test_what_cannot_be_designed_is_refused(changes: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        design_task(trial(**changes))


def test_a_model_file_of_other_equations_is_refused() -> None:
    with pytest.raises(InputError, match="holds the equations 'nomoto', the trial 'waterjet'"):
        design_task(trial(), ModelFile(model_named("nomoto")))


TIME = 0.5 * np.arange(600)


def _trial(rudder_deg: float) -> Trial:
    generator = np.random.default_rng(3)
    delta = np.radians(rudder_deg) * np.clip(4.0 * np.sin(0.1 * TIME), -1.0, 1.0)
    noise = np.radians(0.2) * generator.standard_normal(TIME.size)
    record = Record.from_arrays("run", TIME, {"delta": delta, "psi": 0.3 * np.sin(0.1 * TIME) + noise})
    return Trial(Ship("craft", {"L": 30.0}), (Run(record, Role.TRAIN),), model_named("nomoto"))


def test_orders_go_as_far_as_recorded_and_sensors_are_as_good() -> None:
    request, sensors = recorded_request(_trial(20.0))
    (rudder,) = request.actuators
    assert (request.duration, request.rate) == (pytest.approx(299.5), 1.0)
    assert np.degrees([rudder.lower, rudder.upper]) == pytest.approx([-20.0, 20.0], abs=0.1)
    assert np.degrees(rudder.rate) == pytest.approx(8.0, rel=0.2)
    assert np.degrees(sensors["psi"]) == pytest.approx(0.2, rel=0.2)


def test_a_trial_without_moving_inputs_or_records_is_refused() -> None:
    with pytest.raises(InputError, match="no input moves"):
        recorded_request(_trial(0.0))
    with pytest.raises(InputError, match=r"no table \[design\]"):
        recorded_request(replace(_trial(20.0), runs=()))


def test_of_releases_more_are_advised_in_place_of_orders() -> None:
    released = Record.from_arrays("run", TIME, {"phi": 0.2 * np.exp(-0.01 * TIME) * np.cos(TIME)})
    trial = Trial(Ship("craft", {"L": 3.0}), (Run(released, Role.TRAIN),), model_named("roll"))
    with pytest.raises(InputError, match="orders cannot be designed for releases: record more of them"):
        recorded_request(trial)
