"""Line of sight: the block of a track behind the series of the controller, and the order of one step."""

import math

import numpy as np
import pytest

from seatrial.numerics.kernels import feedback, guidance
from seatrial.numerics.kernels.guidance import track_follower


@pytest.mark.parametrize(("north", "error", "course"), [(0.0, 10.0, 0.0), (99.0, 1.0, math.pi / 2)])
def test_the_order_aims_at_a_point_ahead_on_the_leg(north: float, error: float, course: float) -> None:
    """A corner to the east at 100 m, taken 5 m before it; 10 m to the east of the first leg."""
    count, delta = 2, 10.0
    series = feedback.HEAD_SIZE + 2 * feedback.controller_size(0) + 1
    block = series + 4 * count + 3  # behind reference, disturbance, feed-forward and angles
    memory = np.zeros(block + guidance.TRACK_HEAD + count)
    head = {feedback.COUNT: count, feedback.SERIES: series, feedback.DISTURBED_INPUT: -1, feedback.EFFECT: 1.0}
    unlimited = (feedback.LIMIT, feedback.SLEW, feedback.STALL)
    memory[[*head, *unlimited]] = [*head.values(), *[math.inf] * 3]
    track = {
        guidance.NORTH: 1,
        guidance.EAST: 2,
        guidance.LOOKAHEAD: delta,
        guidance.ORDER_STEP: math.inf,
        guidance.CORNER: 100.0,
        guidance.TURN: math.pi / 2,
        guidance.ACCEPTANCE: 5.0,
        guidance.INTERVAL: 0.1,
    }
    memory[[block + place for place in track]] = list(track.values())
    track_follower(0.0, np.array([0.0, north, 10.0]), memory, np.zeros(1))
    assert memory[block + guidance.TRACK_HEAD] == pytest.approx(error)
    assert memory[series] == pytest.approx(course - math.atan(error / delta))
    assert memory[block + guidance.INTEGRAL] == pytest.approx(0.1 * delta * error / (error**2 + delta**2))
