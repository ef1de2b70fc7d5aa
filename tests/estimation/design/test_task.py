"""What cannot be asked for is refused in one sentence; where a trial begins."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.design.conftest import JET, NOZZLE

from seatrial.core.results import Limits
from seatrial.core.values import InputError
from seatrial.estimation.design.design import design
from seatrial.estimation.design.orders import plan, rows
from seatrial.estimation.design.task import Task
from seatrial.estimation.design.worth import executed


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
def test_an_input_that_cannot_be_moved_so_is_refused(craft: Task, change: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        replace(craft, actuators=(replace(NOZZLE, **change),))


def test_nothing_to_move_to_measure_or_to_find_is_refused(craft: Task) -> None:
    with pytest.raises(InputError, match="needs an input that may be moved"):
        replace(craft, actuators=())
    with pytest.raises(InputError, match="needs its sensors' noise"):
        replace(craft, sensors={})
    known = craft.model.with_parameters(craft.model.parameters.only_free(()))
    with pytest.raises(InputError, match="no free coefficient"):
        replace(craft, model=known)


@pytest.mark.parametrize(("limits", "says"), [(Limits(room=20.0), "distance"), (Limits(drift=-0.1), "drift angle")])
def test_limits_that_the_straight_run_leaves_are_refused(craft: Task, limits: Limits, says: str) -> None:
    with pytest.raises(InputError, match=f"without any order the ship reaches a {says}"):
        design(replace(craft, limits=limits), confirming=0, generations=1)


def test_a_sea_room_that_only_turning_keeps_is_kept(craft: Task) -> None:
    """The straight run leaves it, so that a straight run alone proves nothing about it."""
    made = design(replace(craft, limits=Limits(room=0.7 * _straight(craft))), confirming=0, generations=2)
    assert made.designed.room <= made.limits.room


def _straight(task: Task) -> float:
    return float(task.start[task.model.states.index("u")]) * task.duration


def test_a_trial_begins_straight_ahead_where_surge_balances(craft: Task) -> None:
    """Without any order the craft stays at her first speed and on her course."""
    quiet = plan(craft, np.tile(craft.quiet, (rows(craft, 0.2), 1)), 0.2)
    sailed = executed(craft, quiet, "straight")
    assert sailed.channel("u").values[0] > 0.5
    assert np.ptp(sailed.channel("u").values) < 1e-9
    assert not sailed.channel("psi").values.any()


def test_an_input_begins_at_zero_or_in_the_middle_of_its_range(craft: Task) -> None:
    both = replace(craft, actuators=(NOZZLE, JET), held={})
    assert both.neutral == {"delta": 0.0, "v_j": pytest.approx(1.9)}
