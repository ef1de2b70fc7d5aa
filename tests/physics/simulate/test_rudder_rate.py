"""The rate of a logged rudder, against the rate with which the log was made."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array, Record
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE, rudder_rate, sustained_rudder_rate

RATE, ANGLE, DT = math.radians(12.0), math.radians(25.0), 0.2
"""rad/s, rad and s: a boat's rudder, logged as boats' plotters do."""
TIME = DT * np.arange(600)


def swung(rate: float = RATE) -> Array:
    """A rudder put over at 10 s and to the other side at 60 s."""
    over = np.minimum(ANGLE, rate * np.maximum(0.0, TIME - 10.0))
    return over - np.minimum(2.0 * ANGLE, rate * np.maximum(0.0, TIME - 60.0))


def record(delta: Array) -> Record:
    return Record.from_arrays("run", TIME, {"delta": delta})


def test_rate_is_that_of_the_log() -> None:
    rng = np.random.default_rng(1)
    noisy = swung() + math.radians(0.2) * rng.standard_normal(len(TIME))
    assert sustained_rudder_rate(record(swung())) == pytest.approx(RATE, rel=0.02)
    assert sustained_rudder_rate(record(noisy)) == pytest.approx(RATE, rel=0.06)


def test_a_single_bad_reading_is_no_move() -> None:
    delta = swung()
    delta[300] = 3.0
    assert sustained_rudder_rate(record(delta)) == pytest.approx(RATE, rel=0.02)


def test_a_step_between_two_samples_takes_one_interval() -> None:
    delta = np.where(TIME < 30.0, 0.0, ANGLE)
    assert sustained_rudder_rate(record(delta)) == pytest.approx(ANGLE / DT)


@pytest.mark.parametrize("delta", [np.zeros(len(TIME)), np.full(len(TIME), np.nan), swung(0.5 * SOLAS_SLEW_RATE)])
def test_a_rudder_that_hardly_moves_has_none(delta: Array) -> None:
    assert sustained_rudder_rate(record(delta)) is None


def test_a_run_without_rudder_angles_has_none() -> None:
    assert sustained_rudder_rate(Record.from_arrays("run", TIME, {"r": TIME})) is None


def test_records_decide_where_they_are_clearly_faster() -> None:
    assert rudder_rate(1.0, RATE).value == RATE
    assert "training runs" in rudder_rate(1.0, RATE).text
    assert rudder_rate(1.0).value == SOLAS_SLEW_RATE
    assert rudder_rate(1.0, 1.1 * SOLAS_SLEW_RATE).value == SOLAS_SLEW_RATE
    assert rudder_rate(45.7, RATE).value == pytest.approx(SOLAS_SLEW_RATE * math.sqrt(45.7))
