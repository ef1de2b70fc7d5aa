"""A stretch of a simulated ship: sea, craft and gains; and why there may be none."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.proposals import Look, lines, voyage
from tests.control.proposals.fin_stretches import QUARTERING, SHIP, TASK, fin_schedule, fin_stretch

from seatrial.control.proposals import likeliest_headings, look
from seatrial.core.results.online import Proposal

SCHEDULE = fin_schedule()
STRETCH = fin_stretch(7, QUARTERING)


@pytest.fixture(scope="module")
def proposal() -> Proposal:
    return look(TASK, SCHEDULE, STRETCH)


def test_sea_and_craft_are_inside_their_intervals(proposal: Proposal) -> None:
    sea, (height, period, _) = proposal.sea, np.exp(QUARTERING.sea)
    assert sea is not None
    assert sea.height.lower < height < sea.height.upper
    assert sea.period.lower < period < sea.period.upper
    assert any(one.lower < QUARTERING.beta < one.upper for one in sea.headings)
    assert sum(one.probability for one in sea.headings) >= 0.95
    for craft, factor in zip(proposal.craft, np.exp(SHIP), strict=True):
        assert craft.factor.lower < factor < craft.factor.upper


def test_gains_lie_in_the_schedule_and_keep_their_margins(proposal: Proposal) -> None:
    assert proposal.is_new
    assert proposal.margins is not None
    assert proposal.margins.stable_draws == proposal.margins.draws > 0
    assert proposal.margins.Ms.upper < 1.25 * TASK.constraints.Ms * 1.1
    for k, value in enumerate(proposal.gains.values()):
        assert SCHEDULE.gains[..., k].min() <= value <= SCHEDULE.gains[..., k].max()


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (0.01 * STRETCH.values, "shows too little"),
        (STRETCH.values[:800], "are needed"),
        (np.column_stack([STRETCH.values[:, 0], STRETCH.values[::-1, 1]]), "does not follow 'phi'"),
    ],
)
def test_no_gains_from_a_stretch_that_says_too_little(values: np.ndarray, reason: str) -> None:
    refused = look(TASK, SCHEDULE, replace(STRETCH, values=values))
    assert not refused.has_gains
    assert refused.sea is None
    assert reason in refused.reasons[0]


def test_two_ranges_of_headings_are_two() -> None:
    headings = np.radians(np.concatenate([np.full(70, 31.5), np.full(30, 92.5)]))
    first, second = likeliest_headings(headings)
    assert (math.degrees(first.lower), math.degrees(first.upper)) == pytest.approx((31.0, 32.0))
    assert first.probability == pytest.approx(0.7)
    assert math.degrees(second.lower) == pytest.approx(92.0)


def test_looks_are_counted(proposal: Proposal) -> None:
    looks = [Look(QUARTERING, SHIP, proposal, 0.33, 0.3, is_stable=True)]
    looks += voyage(TASK, SCHEDULE, 3, 1)
    table = {line.quantity: line for line in lines(4, looks)}
    assert table["4 h: unstable proposals on the true ship"].holds
    assert table["looks with a sea estimated"].value >= 50.0
    assert table["roll left over that by gains of the known sea, two hours later"].value > 0.0
