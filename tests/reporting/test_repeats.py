"""Whether a held-out run repeats a trained manoeuvre, by what the runs show."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import zigzag
from tests.reporting.test_verdict import turned, turning_circle

from seatrial.core.results import Fit
from seatrial.core.values import Record
from seatrial.physics.manoeuvres import ManoeuvreKind
from seatrial.reporting.repeats import SteeredOrders, repeat_clause, repeated_runs, steered_orders


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


def test_the_orders_are_those_of_the_run() -> None:
    orders = steered_orders(zigzag("a", 20.0))
    assert orders is not None and orders.kind is ManoeuvreKind.ZIGZAG
    assert math.degrees(orders.rudder) == pytest.approx(20.0, abs=0.5)
    assert math.degrees(orders.heading) == pytest.approx(20.0, abs=1.0)
    assert orders.speed == pytest.approx(0.8, abs=0.05)
    assert steered_orders(zigzag("a", 20.0).without("psi")) is None
    time = np.arange(0.0, 60.0, 0.5)
    straight = Record.from_arrays("s", time, {"delta": 0.0 * time, "psi": 0.0 * time})
    assert steered_orders(straight) is None
    assert not orders.is_repeated_by(replace(orders, heading=0.5 * orders.heading)), "a zigzag 20/10"
    assert SteeredOrders(orders.kind, 0.1, 0.1, math.nan).is_repeated_by(SteeredOrders(orders.kind, 0.11, 0.1, 1.0))


def test_the_clause_names_what_is_repeated_and_what_that_leaves_open(fit: Fit) -> None:
    p = fit.validation[0]
    trained = next(one for one in fit.predictions if one.role == "training")
    clause = repeat_clause(replace(p, measured=trained.measured), fit.predictions)
    assert clause == f"a repeat of {trained.record}, which was fitted: it does not test other manoeuvres"
    assert repeat_clause(p, fit.predictions) == ""
