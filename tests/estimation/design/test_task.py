"""What cannot be asked for is refused in one sentence; where a trial begins."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.design.conftest import BOTH, NOZZLE_RANGE, with_inputs, with_limits

from seatrial.core.results import TrialLimits
from seatrial.core.values import InputError
from seatrial.estimation.design.design import design
from seatrial.estimation.design.manoeuvre_information import planned_record, sample_count, simulate_plan
from seatrial.estimation.design.task import DesignTask


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
