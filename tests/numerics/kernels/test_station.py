"""One order of the station keeper: PID in body axes, shared out, cut where a thruster has no more."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.numerics.kernels import station
from seatrial.numerics.kernels.station import series_start, station_keeper, tables_start


def memory_of(rows: Array, most: float) -> Array:
    """Two fixed thrusters, ten samples, K_p of 2, 3, 5, K_i of 0.1, thrust equal to the share."""
    n, count, size = 2, 10, 3
    series = series_start(n, size)
    memory = np.zeros(series + (station.DISTURBANCES + 3 * n + 1) * count)
    head = {station.THRUSTERS: n, station.COUNT: count, station.HOLD: 1, station.SAMPLE: 0.5, station.TABLE: size,
            station.PSI: 2, station.NORTH: 0, station.EAST: 1, station.FORCE_INPUT: 2}  # fmt: skip
    memory[list(head)] = list(head.values())
    memory[station.KP : station.KP + 9] = np.diag([2.0, 3.0, 5.0]).ravel()
    memory[station.KI : station.KI + 9] = np.diag([0.1, 0.1, 0.1]).ravel()
    for i in range(n):
        row = station.ROWS + i * station.TRAITS
        memory[row : row + 6] = rows[i]
        memory[row + station.COMMAND_INPUT] = i
        memory[row + station.SPAN], memory[row + station.LEAST], memory[row + station.MOST] = 1.0, -most, most
        start = tables_start(n) + 2 * i * size
        memory[start : start + 2 * size] = np.tile([-most, 0.0, most], 2)
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
    assert memory[station.INTEGRAL : station.INTEGRAL + 3] == pytest.approx(np.zeros(3))
    share = series_start(2, 3) + (station.DISTURBANCES + 3 * 2) * 10
    assert memory[share] == pytest.approx(0.5)


def test_an_azimuth_turns_the_short_way_to_the_force_and_stays_where_there_is_none() -> None:
    rows = np.array([[1.0, 0, 0, 0, 1.0, 0], [0.0, 0, 0, 0, 0, 0]])
    memory, u = memory_of(rows, 100.0), np.zeros(5)
    memory[station.ROWS + station.AZIMUTH], memory[station.ROWS + station.ANGLE_INPUT] = 1.0, 1
    memory[station.ROWS + station.TRAITS + station.COMMAND_INPUT] = 4
    memory[station.ROWS + station.DIRECTION] = 3.0
    station_keeper(0.0, np.array([3.0, 1.0, 0.0]), memory, u)
    assert u[0] == pytest.approx(math.hypot(6.0, 3.0))
    assert u[1] == pytest.approx(2.0 * math.pi + math.atan2(-3.0, -6.0))
    station_keeper(0.5, np.array([-0.15, -0.05, 0.0]), memory, u)
    assert abs(u[1] - 3.0) < math.pi


def test_forces_from_outside_and_the_moving_water_reach_the_craft() -> None:
    memory, u = memory_of(np.zeros((2, 6)), 1.0), np.zeros(5)
    series = series_start(2, 3)
    memory[series + 20], memory[series + 30], memory[series + 40] = 7.0, 8.0, 9.0
    station_keeper(0.0, np.zeros(3), memory, u)
    assert u[2:].tolist() == [7.0, 8.0, 9.0]


def test_the_compass_is_read_with_its_error_in_steps() -> None:
    rows = np.array([[0, 0, 1.0, 0, 0, 0], [0, 0, 0, 0, 0, 0]])
    memory, u = memory_of(rows, 100.0), np.zeros(5)
    memory[series_start(2, 3) + 5 * 10], memory[station.RESOLUTION] = 0.07, 0.02
    station_keeper(0.0, np.array([0.0, 0.0, 0.04]), memory, u)
    assert u[0] == pytest.approx(-5.0 * 0.12)
