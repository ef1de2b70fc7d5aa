"""Slews looked for backwards, and rudders of random orders."""

import numpy as np

from seatrial.core.values import Record
from seatrial.physics.manoeuvres import ManoeuvreKind, ObservedManoeuvre, recognise_manoeuvre


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
