"""What was ordered in a run, and what counts as a repeat of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import zigzag

from seatrial.core.values import Record
from seatrial.physics.manoeuvres import ManoeuvreKind, SteeredOrders, initial_speed, ordered_degrees, steered_orders


def test_the_orders_are_those_of_the_run() -> None:
    orders = steered_orders(zigzag("a", 20.0))
    assert orders is not None and orders.kind is ManoeuvreKind.ZIGZAG and not orders.is_turn
    assert math.degrees(orders.rudder) == pytest.approx(20.0, abs=0.5)
    assert math.degrees(orders.heading) == pytest.approx(20.0, abs=1.0)
    assert orders.speed == pytest.approx(0.8, abs=0.05)
    assert steered_orders(zigzag("a", 20.0).without("psi")) is None
    time = np.arange(0.0, 60.0, 0.5)
    straight = Record.from_arrays("s", time, {"delta": 0.0 * time, "psi": 0.0 * time})
    assert steered_orders(straight) is None
    assert not orders.is_repeated_by(replace(orders, heading=0.5 * orders.heading)), "a zigzag 20/10"
    thirty, thirty_five = (SteeredOrders(orders.kind, math.radians(a), 0.1, 1.2) for a in (30.0, 35.0))
    assert not thirty.is_repeated_by(thirty_five) and not thirty_five.is_repeated_by(thirty)
    assert SteeredOrders(orders.kind, 0.1, 0.1, math.nan).is_repeated_by(SteeredOrders(orders.kind, 0.11, 0.1, 1.0))


def test_the_speed_at_the_start_is_that_of_the_first_seconds() -> None:
    time = np.arange(0.0, 20.0, 0.5)
    record = Record.from_arrays("s", time, {"u": np.where(time <= 5.0, 3.0, 1.0)})
    assert initial_speed(record) == pytest.approx(3.0)
    assert math.isnan(initial_speed(record.without("u")))


@pytest.mark.parametrize(
    ("read", "ordered"), [(10.6, 10.0), (20.9, 20.0), (-34.2, -35.0), (11.5, 12.0), (1.0, 1.0), (0.2, 0.0)]
)
def test_angles_are_ordered_in_steps_of_five_degrees(read: float, ordered: float) -> None:
    assert ordered_degrees(math.radians(read)) == ordered
