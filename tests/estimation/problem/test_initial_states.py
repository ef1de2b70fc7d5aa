"""Where a search starts: states as measured, and the velocity of a track that nobody measured."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.problem.segments import (
    cut_segments,
    initial_state_weights,
    measured_initial_states,
    start_velocity,
)
from seatrial.physics.models import model_named

DT = 0.1


def track(rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """A circle of 20 m at 2 m/s in a drift of 6 deg: psi, north, east, yaw rate, with noise of 2 cm."""
    t = DT * np.arange(201)
    course = 0.4 + 0.1 * t
    north, east = 20.0 * np.sin(course), -20.0 * np.cos(course)
    noise = 0.02 * rng.standard_normal((2, len(t)))
    return t, course - np.radians(6.0), north + noise[0], east + noise[1]


def test_the_velocity_of_a_track_is_in_the_axes_of_the_craft(rng: np.random.Generator) -> None:
    _, psi, north, east = track(rng)
    # by hand: 2 m/s along the course, which is 6 deg to starboard of the heading
    u, v = start_velocity(north, east, psi, DT)
    assert (u, v) == pytest.approx((2.0 * np.cos(np.radians(6.0)), 2.0 * np.sin(np.radians(6.0))), abs=0.05)
    north[3:9] = np.nan
    assert start_velocity(north, east, psi, DT)[0] == pytest.approx(u, abs=0.05)
    assert start_velocity(np.full(50, np.nan), east[:50], psi[:50], DT) == (0.0, 0.0)


def test_segments_of_a_track_begin_under_way_and_not_at_rest(rng: np.random.Generator) -> None:
    t, psi, north, east = track(rng)
    channels = {"psi": psi, "x0": north, "y0": east, "delta": 0.0 * t, "v_j": 0.0 * t}
    data = cut_segments(model_named("waterjet"), [Record.from_arrays("a", t, channels)], ("psi", "x0", "y0"), 5.0)
    local = measured_initial_states(data, ("u", "v", "r", "psi", "x0", "y0"))
    assert data.count == 4
    np.testing.assert_allclose(np.hypot(local[:, 0], local[:, 1]), 2.0, atol=0.1)
    np.testing.assert_array_equal(local[:, 2], 0.0)  # of a yaw rate, nothing is known
    np.testing.assert_array_equal(local[:, 3], psi[data.offsets[:-1] - np.arange(data.count)])


def test_a_thin_beginning_starts_with_the_fixes_of_the_run_and_a_prior(rng: np.random.Generator) -> None:
    """Fixes of 1 Hz in rows of 10 Hz: a segment of 2 s holds two of them."""
    t, psi, north, east = track(rng)
    channels = {"psi": psi, "x0": north, "y0": east, "delta": 0.0 * t, "v_j": 0.0 * t}
    record = Record.from_arrays("a", t, channels)
    for name in ("x0", "y0"):
        record = record.with_channel(name, record.channel(name).with_measured(np.arange(len(t)) % 10 == 4))
    data = cut_segments(model_named("waterjet"), [record], ("psi", "x0", "y0"), 2.0)
    local = measured_initial_states(data, ("u", "v", "x0", "y0"))
    np.testing.assert_allclose(np.hypot(local[:, 0], local[:, 1]), 2.0, atol=0.3)
    rows = data.offsets[:-1] - np.arange(data.count)
    np.testing.assert_allclose(local[1:, 2], north[rows][1:], atol=0.2)  # straight between the fixes about them
    weights = initial_state_weights(data, ("u", "v", "x0", "y0"))
    assert np.all(weights[:, 0] > 0.0) and np.all(weights[:, 2] > 0.0)
    assert not initial_state_weights(cut_segments(model_named("waterjet"), [record], ("psi",), 2.0), ("u",)).any()
