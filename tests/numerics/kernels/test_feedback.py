"""A command in the loop: laws, limits, and a track followed."""

import math

import numpy as np
import pytest

from seatrial.numerics.kernels import feedback
from seatrial.numerics.kernels.feedback import clamp, effective_angle, law_size, track_follower

# Parts of a controller: the size of a law, its limits, and what stall leaves of an angle.


def test_a_law_of_order_n_takes_its_matrices() -> None:
    n = 3
    transition, gains, row = n * n, 2 * n, n + 1
    assert law_size(n) == transition + gains + row


@pytest.mark.parametrize(("value", "cut"), [(0.5, 0.5), (2.0, 1.0), (-2.0, -1.0)])
def test_a_value_is_cut_on_both_sides(value: float, cut: float) -> None:
    assert clamp(value, 1.0) == cut


@pytest.mark.parametrize(("angle", "effect"), [(0.2, 0.2), (0.4, 0.25), (-0.4, -0.25), (1.0, 0.0)])
def test_beyond_stall_the_lift_falls_to_nothing(angle: float, effect: float) -> None:
    assert effective_angle(angle, stall=0.3, loss=0.5) == pytest.approx(effect)


# Line of sight: the block of a track behind the series of the controller, and the order of one step.


@pytest.mark.parametrize(("north", "error", "course"), [(0.0, 10.0, 0.0), (99.0, 1.0, math.pi / 2)])
def test_the_order_aims_at_a_point_ahead_on_the_leg(north: float, error: float, course: float) -> None:
    """A corner to the east at 100 m, taken 5 m before it; 10 m to the east of the first leg."""
    count, delta = 2, 10.0
    sensor, servo, noise = feedback.HEAD_SIZE + np.array([0, law_size(0) + 1, 2 * law_size(0) + 1])
    series = noise + count
    answers = series + 3 * count  # behind reference, disturbance and feed-forward
    block = answers + 3 * (count + 1)
    memory = np.zeros(block + feedback.TRACK_HEAD)
    head = {
        feedback.COUNT: count,
        feedback.SERIES: series,
        feedback.ANSWERS: answers,
        feedback.TRACK: block,
        feedback.EVERY: 1,
        feedback.SENSOR: sensor,
        feedback.SERVO: servo,
        feedback.NOISE: noise,
        feedback.DISTURBED_INPUT: -1,
        feedback.EFFECT: 1.0,
    }
    unlimited = (feedback.LIMIT, feedback.SLEW, feedback.SAMPLE_SLEW, feedback.STALL)
    memory[[*head, *unlimited]] = [*head.values(), *[math.inf] * len(unlimited)]
    track = {
        feedback.NORTH: 1,
        feedback.EAST: 2,
        feedback.LOOKAHEAD: delta,
        feedback.ORDER_STEP: math.inf,
        feedback.CORNER: 100.0,
        feedback.TURN: math.pi / 2,
        feedback.ACCEPTANCE: 5.0,
        feedback.INTERVAL: 0.1,
    }
    memory[[block + place for place in track]] = list(track.values())
    track_follower(0.0, np.array([0.0, north, 10.0]), memory, np.zeros(1))
    assert memory[answers + count + 1] == pytest.approx(error)
    assert memory[series] == pytest.approx(course - math.atan(error / delta))
    assert memory[block + feedback.INTEGRAL] == pytest.approx(0.1 * delta * error / (error**2 + delta**2))
