"""The time in which a ship changes its motion, of records with and without speed."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.estimation.estimate.settings import (
    SAMPLES_OF_CHANGE,
    WEAK_FORM_SHIP_LENGTHS,
    characteristic_time,
    resolved_time,
    weak_form_half_width,
    yaw_time,
)
from seatrial.physics.models.mmg import mmg_roll
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


@pytest.mark.parametrize("period", [8.0, 400.0])
def test_windows_of_a_start_are_no_wider_than_a_roll_and_no_wider_than_without_it(period: float) -> None:
    decay = Record.from_arrays("decay", TIME, {"p": np.exp(-0.01 * TIME) * np.sin(2.0 * np.pi * TIME / period)})
    still = Record.from_arrays("straight", TIME, {"p": np.zeros(TIME.size)})
    wide = WEAK_FORM_SHIP_LENGTHS * 25.0
    assert weak_form_half_width(nomoto(), [decay], 25.0) == wide  # does not roll
    assert weak_form_half_width(mmg_roll(), [still], 25.0) == wide
    assert weak_form_half_width(mmg_roll(), [still, decay], 25.0) == pytest.approx(min(0.6 * period, wide), rel=0.02)


def test_records_without_speed_and_yaw_are_refused() -> None:
    with pytest.raises(InputError, match="neither speed nor yaw"):
        yaw_time([Record.from_arrays("run", TIME, {"delta": RATE})])
