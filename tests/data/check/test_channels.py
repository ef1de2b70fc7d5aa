"""Positions of few digits come in steps; a sensor that stopped does not."""

from dataclasses import replace

import numpy as np
import pytest
from tests.data.check.ship import with_values, zigzag

from seatrial.core.values import Array, Severity
from seatrial.data.check import examine
from seatrial.data.check.channels import channel_findings

STEP = 10.0  # m


def test_positions_in_steps_of_ten_metres_are_no_stuck_sensor() -> None:
    record = zigzag(noise=1.0)
    coarse = STEP * np.rint(np.linspace(0.0, 30.0 * STEP, len(record)) / STEP)
    (finding,) = [f for f in channel_findings(with_values(record, x0=coarse)) if "'x0'" in f.message]
    assert finding.code == "resolution" and "steps of 10 m" in finding.message


def test_a_coarse_sensor_that_stops_is_stuck() -> None:
    record = zigzag(noise=1.0)
    coarse = STEP * np.rint(np.linspace(0.0, 30.0 * STEP, len(record)) / STEP)
    coarse[1000:2000] = coarse[1000]
    codes = {f.code for f in channel_findings(with_values(record, x0=coarse)) if "'x0'" in f.message}
    assert codes == {"stuck"}


def test_a_course_in_whole_degrees_that_goes_on_across_north_is_no_stuck_compass() -> None:
    """360 deg is 0 deg: the heading moves on by one step where it wraps."""
    record = zigzag(noise=1.0)
    heading = np.where(np.arange(len(record)) < 500, 0.0, 359.0)
    heading[1000:] = 358.0 - np.arange(len(record) - 1000) // 50 % 12
    (finding,) = [
        f for f in channel_findings(with_values(record, psi=np.radians(heading))) if "'psi' comes" in f.message
    ]
    assert finding.code == "resolution" and "steps of 1 deg" in finding.message


def digits(values: Array) -> Array:
    return np.array([float(f"{value:.3g}") for value in values])


def whole_degrees(values: Array) -> Array:
    return np.radians(np.round(np.degrees(values)))


def test_a_speed_and_a_course_that_both_stay_are_a_steady_ship() -> None:
    """Velocity north and east of a speed to 0.1 kn and a course to 1 deg: a pair that stays has no resolution of its
    own, speed and course have."""
    record = zigzag(noise=1.0)
    speed = np.round(6.0 + 0.2 * np.sin(np.arange(len(record)) / 300.0), 1)
    course = np.radians(np.round(290.0 + np.maximum(np.arange(len(record)) - 500, 0) / 80.0))
    over_ground = {
        symbol: replace(record.channel(symbol), values=values, frame="earth")
        for symbol, values in (("u", speed * np.cos(course)), ("v", speed * np.sin(course)))
    }
    findings = channel_findings(replace(record, channels={**record.channels, **over_ground}))
    assert {f.code for f in findings if "'u'" in f.message or "'v'" in f.message} == {"resolution"}


@pytest.mark.parametrize("symbols", [("psi", "delta"), ("x0", "y0", "psi", "u", "v", "r", "delta")])
def test_coarse_readings_are_neither_stuck_nor_repeated_nor_jumps(symbols: tuple[str, ...]) -> None:
    record = zigzag(noise=1.0)
    write = whole_degrees if len(symbols) == 2 else digits
    coarse = with_values(record, **{symbol: write(record[symbol]) for symbol in symbols})
    codes = {f.code for f in examine(coarse) if f.severity is not Severity.INFO}
    assert codes <= {f.code for f in examine(record)}
