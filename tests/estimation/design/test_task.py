"""What cannot be asked for is refused in one sentence; where a trial begins."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.design.conftest import JET, NOZZLE

from seatrial.core.results import TrialLimits
from seatrial.core.values import InputError
from seatrial.estimation.design.design import design
from seatrial.estimation.design.manoeuvre_information import simulate_plan
from seatrial.estimation.design.orders import planned_record, sample_count
from seatrial.estimation.design.task import DesignTask


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"name": "delt"}, "'delt' is no input of model 'waterjet'.*delta"),
        ({"lower": 0.6, "upper": 0.6}, "cannot move from 0.6 to 0.6"),
        ({"upper": math.inf}, "cannot move from .* to inf"),
        ({"upper": math.nan}, "cannot move from .* to nan"),
        ({"rate": 0.0}, "cannot move at a rate of 0"),
        ({"rate": math.nan}, "cannot move at a rate of nan"),
        ({"rate": 1e-3}, "does not cross its range"),
        ({"hold": 0.0}, "held for 0 s"),
        ({"hold": 60.0}, "180 s leave no room for 4 orders"),
    ],
)
def test_an_input_that_cannot_be_moved_so_is_refused(craft: DesignTask, change: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        replace(craft, actuators=(replace(NOZZLE, **change),))


def test_nothing_to_move_to_measure_or_to_find_is_refused(craft: DesignTask) -> None:
    with pytest.raises(InputError, match="needs an input that may be moved"):
        replace(craft, actuators=())
    with pytest.raises(InputError, match="needs its sensors' noise"):
        replace(craft, sensors={})
    known = craft.model.with_parameters(craft.model.parameters.only_free(()))
    with pytest.raises(InputError, match="no free coefficient"):
        replace(craft, model=known)


@pytest.mark.parametrize(
    ("limits", "says"), [(TrialLimits(sea_room=20.0), "distance"), (TrialLimits(drift=-0.1), "drift angle")]
)
def test_limits_that_the_straight_run_leaves_are_refused(craft: DesignTask, limits: TrialLimits, says: str) -> None:
    with pytest.raises(InputError, match=f"without any order the ship reaches a {says}"):
        design(replace(craft, limits=limits), confirmation_runs=0, generations=1)


def test_a_sea_room_that_only_turning_keeps_is_kept(craft: DesignTask) -> None:
    """The straight run leaves it, so that a straight run alone proves nothing about it."""
    made = design(
        replace(craft, limits=TrialLimits(sea_room=0.7 * _straight(craft))), confirmation_runs=0, generations=2
    )
    assert made.designed.distance <= made.limits.sea_room


def _straight(task: DesignTask) -> float:
    return float(task.initial_state[task.model.states.index("u")]) * task.duration


def test_a_trial_begins_straight_ahead_where_surge_balances(craft: DesignTask) -> None:
    """Without any order the craft stays at her first speed and on her course."""
    quiet = planned_record(craft, np.tile(craft.neutral_inputs, (sample_count(craft, 0.2), 1)), 0.2)
    sailed = simulate_plan(craft, quiet, "straight")
    assert sailed.channel("u").values[0] > 0.5
    assert np.ptp(sailed.channel("u").values) < 1e-9
    assert not sailed.channel("psi").values.any()


def test_an_input_begins_at_zero_or_in_the_middle_of_its_range(craft: DesignTask) -> None:
    both = replace(craft, actuators=(NOZZLE, JET), held={})
    assert both.neutral_positions == {"delta": 0.0, "v_j": pytest.approx(1.9)}
