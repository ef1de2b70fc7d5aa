"""One order of the station keeper: PID in body axes, shared out, cut where a thruster has no more."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.numerics.kernels import feedback, station
from seatrial.numerics.kernels.station import station_keeper

LAW, COUNT, THRUSTERS, TABLE = feedback.HEAD_SIZE, 10, 2, 3
"""Place of the law, samples, thrusters, and rows of their tables."""
SERIES = LAW + station.ROWS + THRUSTERS * (station.TRAITS + 2 * TABLE)
NOISE = SERIES + 6 * COUNT
ANSWERS = NOISE + COUNT


def memory_of(rows: Array, most: float) -> Array:
    """Two fixed thrusters, ten samples, K_p of 2, 3, 5, K_i of 0.1, thrust equal to the share."""
    memory = np.zeros(ANSWERS + (THRUSTERS + 1) * (COUNT + 1))
    head = {feedback.COUNT: COUNT, feedback.EVERY: 1, feedback.LAW: LAW, feedback.NOISE: NOISE,
            feedback.SERIES: SERIES, feedback.ANSWERS: ANSWERS, feedback.DISTURBED_INPUT: 2}  # fmt: skip
    memory[list(head)] = list(head.values())
    law = memory[LAW:]
    law[station.KP : station.KP + 9] = np.diag([2.0, 3.0, 5.0]).ravel()
    law[station.KI : station.KI + 9] = np.diag([0.1, 0.1, 0.1]).ravel()
    law[station.POSE : station.POSE + 3] = 0, 1, 2
    law[station.SAMPLE], law[station.THRUSTERS], law[station.TABLE] = 0.5, THRUSTERS, TABLE
    for i in range(THRUSTERS):
        row = station.ROWS + i * station.TRAITS
        law[row : row + 6] = rows[i]
        law[row + station.COMMAND_INPUT] = i
        law[row + station.SPAN], law[row + station.LEAST], law[row + station.MOST] = 1.0, -most, most
        start = station.ROWS + THRUSTERS * station.TRAITS + 2 * i * TABLE
        law[start : start + 2 * TABLE] = np.tile([-most, 0.0, most], 2)
    return memory


def test_an_error_becomes_a_force_in_body_axes() -> None:
    """Heading east, 1 m north of the station: the station is to starboard of the bow, so the force is to starboard."""
    rows = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0, 0]])
    memory, u = memory_of(rows, 100.0), np.zeros(5)
    station_keeper(0.0, np.array([1.0, 0.0, 0.5 * math.pi]), memory, u)
    assert u[:2] == pytest.approx([0.0, 3.0], abs=1e-12)
    station_keeper(0.5, np.array([1.0, 0.0, 0.5 * math.pi]), memory, u)
    assert u[:2] == pytest.approx([0.0, 3.0 + 0.1 * 0.5], abs=1e-12)


def test_what_is_beyond_a_limit_cuts_all_and_holds_the_integral() -> None:
    rows = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0, 0]])
    memory, u = memory_of(rows, 1.5), np.zeros(5)
    station_keeper(0.0, np.array([-1.0, 1.0, 0.0]), memory, u)
    assert u[:2] == pytest.approx([1.0, -1.5])
    for k in range(1, 3):
        station_keeper(0.5 * k, np.array([-1.0, 1.0, 0.0]), memory, u)
    assert memory[LAW + station.INTEGRAL : LAW + station.INTEGRAL + 3] == pytest.approx(np.zeros(3))
    assert memory[ANSWERS + THRUSTERS * (COUNT + 1)] == pytest.approx(0.5)


def test_an_azimuth_turns_the_short_way_to_the_force_and_stays_where_there_is_none() -> None:
    rows = np.array([[1.0, 0, 0, 0, 1.0, 0], [0.0, 0, 0, 0, 0, 0]])
    memory, u = memory_of(rows, 100.0), np.zeros(5)
    first = LAW + station.ROWS
    memory[first + station.AZIMUTH], memory[first + station.ANGLE_INPUT] = 1.0, 1
    memory[first + station.TRAITS + station.COMMAND_INPUT] = 4
    memory[first + station.DIRECTION] = 3.0
    station_keeper(0.0, np.array([3.0, 1.0, 0.0]), memory, u)
    assert u[0] == pytest.approx(math.hypot(6.0, 3.0))
    assert u[1] == pytest.approx(2.0 * math.pi + math.atan2(-3.0, -6.0))
    station_keeper(0.5, np.array([-0.15, -0.05, 0.0]), memory, u)
    assert abs(u[1] - 3.0) < math.pi


def test_forces_from_outside_reach_the_craft() -> None:
    memory, u = memory_of(np.zeros((2, 6)), 1.0), np.zeros(5)
    memory[SERIES + 3 * COUNT : SERIES + 6 * COUNT : COUNT] = 7.0, 8.0, 9.0
    station_keeper(0.0, np.zeros(3), memory, u)
    assert u[2:].tolist() == [7.0, 8.0, 9.0]


def test_the_compass_is_read_with_its_error_in_steps() -> None:
    rows = np.array([[0, 0, 1.0, 0, 0, 0], [0, 0, 0, 0, 0, 0]])
    memory, u = memory_of(rows, 100.0), np.zeros(5)
    memory[NOISE], memory[feedback.RESOLUTION] = 0.07, 0.02
    station_keeper(0.0, np.array([0.0, 0.0, 0.04]), memory, u)
    assert u[0] == pytest.approx(-5.0 * 0.12)


def test_a_pose_to_be_kept_that_goes_is_followed_as_if_the_water_went_the_other_way() -> None:
    rows = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0, 0]])
    memory, u = memory_of(rows, 100.0), np.zeros(5)
    memory[SERIES], memory[SERIES + COUNT] = 1.0, -2.0
    station_keeper(0.0, np.zeros(3), memory, u)
    assert u[:2] == pytest.approx([2.0, -6.0], abs=1e-12)


def test_an_order_waits_for_the_dead_time() -> None:
    rows = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0, 0]])
    memory, u = np.concatenate([memory_of(rows, 100.0), np.zeros(2 * THRUSTERS * 3)]), np.zeros(5)
    memory[feedback.QUEUE], memory[feedback.QUEUE_SIZE] = len(memory) - 2 * THRUSTERS * 3, 3
    ahead = []
    for k in range(5):
        station_keeper(0.5 * k, np.array([-float(k + 1), 0.0, 0.0]), memory, u)
        ahead.append(u[0])
    assert ahead[:3] == [0.0, 0.0, 0.0]
    assert ahead[3:] == pytest.approx([2.0, 2.0 * 2.0 + 0.1 * 0.5 * 1.5], abs=1e-12)
