"""Slews looked for backwards, rudders of random orders, and what was ordered in a run."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import zigzag

from seatrial.core.values import Record
from seatrial.physics.manoeuvres import (
    ManoeuvreKind,
    ObservedManoeuvre,
    SteeredOrders,
    initial_speed,
    ordered_degrees,
    programme,
    recognise_manoeuvre,
    steered_orders,
)
from seatrial.physics.models import nomoto
from seatrial.physics.simulate import manoeuvre


def ordered(seconds: float, count: int) -> Record:
    """A rudder slewing at 5 deg/s to orders of 10 deg to either side in turn, 10 Hz."""
    orders = np.radians(10.0) * np.repeat(np.resize([1.0, -1.0], count), round(10 * seconds))
    delta, step = np.zeros(len(orders)), np.radians(0.5)
    for n in range(1, len(orders)):
        delta[n] = delta[n - 1] + np.clip(orders[n] - delta[n - 1], -step, step)
    channels = {"delta": delta, "psi": np.cumsum(0.01 * delta)}
    return Record.from_arrays("orders", 0.1 * np.arange(len(delta)), channels)


def test_executes_are_where_the_slews_begin() -> None:
    """Orders every 60 s."""
    manoeuvre = ObservedManoeuvre.from_record(ordered(60.0, 8))
    np.testing.assert_allclose(manoeuvre.executes[1:], 60.0 * np.arange(1, 8), atol=0.15)


def test_a_thousand_orders_are_a_programme_and_no_manoeuvre() -> None:
    record = ordered(6.0, 1100)
    assert ObservedManoeuvre.from_record(record).holds == ()
    assert recognise_manoeuvre(record) is ManoeuvreKind.OTHER


def test_a_zigzag_is_known_though_its_rudder_slews_longer_than_it_holds() -> None:
    """10 deg of heading are reached soon behind 20 deg of rudder; overshoot 1 counts from execute 2."""
    ship = nomoto().with_values({"K": 0.2, "T": 3.0, "U": 5.0})
    record = manoeuvre(ship, programme("zigzag:20/10"), slew_rate=np.radians(4.5))
    seen = ObservedManoeuvre.from_record(record)
    assert seen.kind is ManoeuvreKind.ZIGZAG and len(seen.holds) == 5
    assert np.degrees(seen.psi_at(seen.executes[1])) == pytest.approx(10.0, abs=0.3)


def test_a_rudder_that_turns_back_as_it_arrives_was_put_over() -> None:
    """A 30/10 zigzag of a ship that turns fast: the first peak has no flat part, and is its first execute."""
    time = np.arange(0.0, 60.0, 0.05)
    corners = [(0.0, 0.0), (12.0, 0.0), (15.0, 30.0), (21.0, -30.0), (27.0, -30.0), (33.0, 30.0), (39.0, 30.0),
               (45.0, -30.0), (60.0, -30.0)]  # fmt: skip
    delta = np.radians(np.interp(time, *zip(*corners, strict=True)))
    r = np.zeros(len(time))
    for k in range(1, len(time)):
        r[k] = r[k - 1] + 0.05 * (0.5 * delta[k - 1] - r[k - 1])  # Nomoto's first order, K 0.5, T 1 s
    record = Record.from_arrays("30/10", time, {"delta": delta, "psi": np.cumsum(r) * 0.05})
    run = ObservedManoeuvre.from_record(record)
    assert run.kind is ManoeuvreKind.ZIGZAG
    np.testing.assert_allclose(run.executes, [12.0, 15.0, 27.0, 39.0], atol=0.1)
    assert np.degrees(run.holds[0].angle) == pytest.approx(30.0, abs=0.5)


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
