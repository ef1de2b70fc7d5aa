"""The rule that takes gains out of a schedule: margins over the draws, hysteresis, the schedule's ends."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.control.proposals.fin_stretches import QUARTERING, TASK, fin_schedule

from seatrial.control.proposals import ChosenGains, Refusal, estimated, propose_gains
from seatrial.core.values import Array
from seatrial.estimation.sea import ShipInSea

SCHEDULE = fin_schedule()
COUNT = 8


def draws(height: float = 3.0) -> ShipInSea:
    """Crafts and seas about one, a twentieth apart."""
    rng = np.random.default_rng(1)
    sea = QUARTERING.sea
    seas = np.array([math.log(height), sea[1], sea[2]]) + rng.normal(0.0, 0.05, (COUNT, 3))
    return ShipInSea(rng.normal(QUARTERING.beta, 0.05, COUNT), rng.normal(0.0, 0.05, (COUNT, 3)), seas)


def chosen(current: Array | None = None, U: float = 9.26) -> ChosenGains:
    """What is proposed for these draws."""
    choice = propose_gains(TASK, SCHEDULE, draws(), U, current)
    assert isinstance(choice, ChosenGains)
    return choice


@pytest.fixture(scope="module")
def choice() -> ChosenGains:
    return chosen()


def test_gains_lie_in_the_schedule_and_keep_their_margins(choice: ChosenGains) -> None:
    assert choice.is_new
    assert choice.margins.stable_draws == choice.margins.draws == COUNT
    assert choice.margins.Ms.upper < 1.25 * TASK.constraints.Ms
    for k, value in enumerate(choice.gains):
        assert SCHEDULE.gains[..., k].min() <= value <= SCHEDULE.gains[..., k].max()


def test_gains_that_hold_are_left_as_they_are(choice: ChosenGains) -> None:
    again = chosen(0.99 * choice.gains)
    assert not again.is_new
    np.testing.assert_array_equal(again.gains, 0.99 * choice.gains)
    assert again.reasons[1] == "They were proposed before; no other set leaves 3 % less."


def test_gains_that_leave_more_motion_are_replaced(choice: ChosenGains) -> None:
    again = chosen(0.5 * choice.gains)
    assert again.is_new
    assert "Those proposed before leave" in again.reasons[1]


def test_gains_that_do_not_hold_are_replaced() -> None:
    assert "Those proposed before no longer hold: an unstable loop on" in chosen(np.array([0.0, 0.0, 1e5])).reasons[1]


def test_no_gains_where_a_margin_fails() -> None:
    strict = replace(TASK, constraints=replace(TASK.constraints, Ms=0.8))
    refused = propose_gains(strict, SCHEDULE, draws(), 9.26, None)
    assert isinstance(refused, Refusal)
    assert refused.reasons[0].startswith("no gains of the schedule hold: the best of them has Ms")


def test_no_gains_outside_the_schedule() -> None:
    fast, high = (
        propose_gains(TASK, SCHEDULE, draws(), 12.0, None),
        propose_gains(TASK, SCHEDULE, draws(9.0), 9.0, None),
    )
    assert fast.reasons[0].startswith("the speed, 12 m/s, lies outside the schedule's 7 to 11.5 m/s")
    assert "lies outside the schedule's 1 to 6 m; tune a schedule that covers it" in high.reasons[0]


def test_intervals_are_the_middle_of_the_draws() -> None:
    one = estimated(np.append(np.arange(40.0), np.inf))
    assert (one.lower, one.value, one.upper) == (1.0, 20.0, 39.0)
