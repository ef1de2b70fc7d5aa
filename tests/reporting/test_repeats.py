"""Whether a held-out run repeats a trained manoeuvre, by what the runs show."""

import math
from dataclasses import replace

import pytest
from tests.reporting.fabricated import zigzag
from tests.reporting.test_verdict import turned, turning_circle

from seatrial.core.results import Fit
from seatrial.core.values import Record
from seatrial.reporting.repeats import repeat_clause, repeated_runs


def repeated(fit: Fit, held: Record, trained: Record) -> bool:
    """Whether the first of two runs counts as a repeat of the second one."""
    p = fit.validation[0]
    runs = (replace(p, measured=held), replace(p, record="trained", role="training", measured=trained))
    return repeated_runs(runs[0], runs) == ["trained"]


def test_a_zigzag_repeats_one_of_the_same_orders_alone(fit: Fit) -> None:
    twenty = zigzag("a", 20.0)
    assert repeated(fit, twenty, zigzag("b", 20.0, duration=180.0))
    assert not repeated(fit, twenty, zigzag("b", 30.0))
    assert not repeated(fit, twenty, turning_circle(math.radians(20.0)))
    faster = zigzag("b", 20.0)
    faster = faster.with_channel("u", faster.channel("u").with_values(1.5 * faster["u"]))
    assert not repeated(fit, twenty, faster)
    assert repeated(fit, twenty, zigzag("b", 20.0).without("u")), "a speed that was not recorded is not compared"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_turn_repeats_one_to_the_same_side_alone(fit: Fit, side: float) -> None:
    turn = turning_circle(side * math.radians(35.0))
    assert repeated(fit, turn, turned(turn))
    assert not repeated(fit, turn, turning_circle(-side * math.radians(35.0)))
    assert not repeated(fit, turn, turning_circle(side * math.radians(20.0)))


def test_the_clause_names_what_is_repeated_and_what_that_leaves_open(fit: Fit) -> None:
    p = fit.validation[0]
    trained = next(one for one in fit.predictions if one.role == "training")
    clause = repeat_clause(replace(p, measured=trained.measured), fit.predictions)
    assert clause == f"a repeat of {trained.record}, which was fitted: it does not test other manoeuvres"
    assert repeat_clause(p, fit.predictions) == ""
