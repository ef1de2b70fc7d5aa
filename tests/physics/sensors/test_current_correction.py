"""A circle in a known current, corrected, against the same circle in still water; all in closed form."""

import numpy as np
import pytest

from seatrial.core.results.prediction import EstimatedCurrent
from seatrial.core.values import Record
from seatrial.physics.manoeuvres import measures
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.sensors import Sensors, with_sensors
from seatrial.physics.sensors.measured_outputs import shows_ground_velocity, without_current
from seatrial.physics.sensors.settings import VelocityReference

RADIUS, SPEED, LENGTH = 20.0, 2.0, 10.0
"""m, m/s, m: the circle's tactical diameter is 4 L, its half turn lasts pi 20 m / 2 m/s = 31.4 s."""
CURRENT = EstimatedCurrent(0.2, 0.1)
"""m/s; in the half turn the track drifts east, to the side turned to, by 3.14 m: tactical diameter 4.31 L."""


def circle(current: EstimatedCurrent | None = None) -> Record:
    """A straight run of 10 s to the north, then at once a circle to starboard; u and v over ground."""
    time = np.arange(0.0, 100.0, 0.1)
    over = np.clip(time - 10.0, 0.0, None)
    psi = SPEED / RADIUS * over
    north, east = (0.0, 0.0) if current is None else (current.north, current.east)
    values = {
        "x0": SPEED * np.minimum(time, 10.0) + RADIUS * np.sin(psi) + north * time,
        "y0": RADIUS * (1.0 - np.cos(psi)) + east * time,
        "psi": psi,
        "u": SPEED + north * np.cos(psi) + east * np.sin(psi),
        "v": -north * np.sin(psi) + east * np.cos(psi),
        "delta": np.where(time > 10.0 + 1e-9, np.radians(35.0), 0.0),
    }
    return Record.from_arrays("circle", time, values)


def test_the_corrected_circle_is_that_of_still_water() -> None:
    over_ground = measures(circle(CURRENT), LENGTH)
    assert over_ground["tactical_diameter_L"] == pytest.approx(4.0 + 0.1 * np.pi * 10.0 / LENGTH, abs=2e-3)
    assert over_ground["approach_speed"] == pytest.approx(np.hypot(2.2, 0.1), rel=1e-6)
    corrected = measures(without_current(circle(CURRENT), CURRENT, has_ground_velocity=True), LENGTH)
    assert corrected == pytest.approx(measures(circle(), LENGTH), abs=1e-9)
    assert corrected["tactical_diameter_L"] == pytest.approx(4.0, abs=1e-3)


def test_velocities_through_the_water_are_left_alone() -> None:
    record = circle(CURRENT)
    corrected = without_current(record, CURRENT, has_ground_velocity=False)
    np.testing.assert_array_equal(corrected["u"], record["u"])
    assert without_current(record, None, has_ground_velocity=True) is record


def test_a_track_alone_gives_the_speed_through_the_water() -> None:
    """Positions with 0.1 m of noise, no u and v: approach 2 m/s, final diameter 2 U / r = 4 L."""
    record, rng = circle(CURRENT), np.random.default_rng(2)
    noisy = {s: record[s] + (0.1 * rng.standard_normal(len(record)) if s in ("x0", "y0") else 0.0)
             for s in ("x0", "y0", "psi", "delta")}  # fmt: skip
    track = without_current(Record.from_arrays("track", record.time, noisy), CURRENT, has_ground_velocity=True)
    found = measures(track, LENGTH)
    assert found["approach_speed"] == pytest.approx(SPEED, rel=0.02)
    assert found["steady_diameter_L"] == pytest.approx(4.0, rel=0.02)
    assert found["speed_loss"] == pytest.approx(0.0, abs=0.02)


def test_a_trial_that_declares_velocities_over_ground_has_the_current_in_them() -> None:
    model = kvlcc2()
    assert not shows_ground_velocity(model)
    assert not shows_ground_velocity(with_sensors(model, Sensors(yaw_rate_bias=True)))
    assert shows_ground_velocity(with_sensors(model, Sensors(velocity=VelocityReference.GROUND)))
