"""The time in which a ship changes its motion, of records with and without speed."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.estimation.estimate.settings import SAMPLES_OF_CHANGE, characteristic_time, resolved_time, yaw_time
from seatrial.physics.models.nomoto import nomoto

TIME = np.arange(0.0, 600.0, 0.5)
RATE = 0.01 * np.sin(2.0 * np.pi * TIME / 100.0)


def test_a_steering_model_needs_rudder_and_yaw_rate_only() -> None:
    record = Record.from_arrays("run", TIME, {"r": RATE, "delta": np.sign(RATE)})
    assert characteristic_time(nomoto(), [record], 100.0) == pytest.approx(100.0 / (2.0 * np.pi), rel=0.02)
    heading = Record.from_arrays("run", TIME, {"psi": np.cumsum(RATE) * 0.5, "delta": np.sign(RATE)})
    assert yaw_time([heading]) == pytest.approx(100.0 / (2.0 * np.pi), rel=0.02)


def test_a_speed_counts_where_there_is_one() -> None:
    record = Record.from_arrays("run", TIME, {"r": RATE, "u": np.full(TIME.size, 4.0)})
    assert characteristic_time(nomoto(), [record], 100.0) == pytest.approx(25.0)


@pytest.mark.parametrize(("every", "expected"), [(1, 25.0), (20, SAMPLES_OF_CHANGE * 10.0)])
def test_records_show_no_change_that_is_quicker_than_their_slowest_channel(every: int, expected: float) -> None:
    fixes = np.where(np.arange(TIME.size) % every == 0, np.cumsum(RATE), np.nan)
    record = Record.from_arrays("run", TIME, {"u": np.full(TIME.size, 4.0), "psi": fixes, "delta": np.sign(RATE)})
    assert resolved_time(nomoto(), [record], 100.0) == pytest.approx(expected, rel=0.01)


def test_records_without_speed_and_yaw_are_refused() -> None:
    with pytest.raises(InputError, match="neither speed nor yaw"):
        yaw_time([Record.from_arrays("run", TIME, {"delta": RATE})])
