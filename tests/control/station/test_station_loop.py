"""The loop of a station: poles where they are placed, sensitivity by python-control, margins of a single axis."""

import math

import control
import numpy as np
import pytest
from tests.control.station.station_cases import craft, cross_drive

from seatrial.control.station.craft import generalised_inverse
from seatrial.control.station.station_loop import StationLoop, place_poles, station_point
from seatrial.core.equations import Model
from seatrial.core.values import Array

OMEGA = np.geomspace(1e-3, 1e2, 60)
BANDWIDTH = np.array([0.4, 0.4, 0.7])


def loop_of(model: Model, speed: float = 0.0, direction: float = 0.0, dead_time: float = 0.15) -> StationLoop:
    on_station = craft(model)
    gains = place_poles(on_station.inertia, on_station.damping, BANDWIDTH)
    frequencies = np.geomspace(1e-3, 1e2, 400)
    inverse = generalised_inverse(on_station)
    return StationLoop(
        station_point(on_station, speed, direction, inverse), gains, inverse, dead_time,
        np.ones(len(on_station.owner)), frequencies,
    )  # fmt: skip


def test_poles_are_where_they_are_placed() -> None:
    """M s^3 + (D + K_d) s^2 + K_p s + K_i has -w twice and -0.1 w in every degree of freedom, M coupled, too."""
    M = np.array([[2.0, 0.0, 0.0], [0.0, 3.0, 0.4], [0.0, 0.4, 1.5]])
    D = np.array([[0.1, 0.0, 0.0], [0.0, 0.2, 0.05], [0.0, -0.02, 0.1]])
    g = place_poles(M, D, BANDWIDTH)
    weight = np.linalg.inv(M)
    top = np.hstack([-weight @ (D + g.KD), -weight @ g.KP, -weight @ g.KI])
    poles = np.linalg.eigvals(np.vstack([top, np.eye(6, 9)]))
    expected = np.sort(np.concatenate([-BANDWIDTH, -BANDWIDTH, -0.1 * BANDWIDTH]))
    assert np.sort(poles.real) == pytest.approx(expected, rel=1e-5)  # square root of rounding: double poles
    assert np.abs(poles.imag).max() < 1e-5


def test_a_hull_that_damps_more_is_not_driven() -> None:
    assert np.all(np.diag(place_poles(np.eye(3), 100.0 * np.eye(3), BANDWIDTH).KD) == 0.0)


def sensitivity_by_python_control(loop: StationLoop) -> control.StateSpace:
    """Plant, thrusters with their lags and the controller as state spaces of python-control, connected by it."""
    own, g = loop.craft, loop.gains
    plant = control.ss(loop.point.A, loop.point.force_input, np.eye(3, 6), np.zeros((3, 3)))
    lags = control.append(*(control.ss(control.tf([1.0], [lag, 1.0])) for lag in own.lags))
    by_thrusters = control.ss([], [], [], own.configuration) * lags * control.ss([], [], [], loop.inverse)
    integral = control.append(*(control.ss(control.tf([1.0], [1.0, 0.0])) for _ in range(3)))
    velocity = control.append(*(control.ss(control.tf([1.0, 0.0], [lag, 1.0])) for lag in g.lag))
    gain = control.ss([], [], [], g.KP + loop.turning)
    gain += control.ss([], [], [], g.KI) * integral + control.ss([], [], [], g.KD) * velocity
    return control.feedback(control.ss([], [], [], np.eye(3)), plant * by_thrusters * gain)


@pytest.mark.parametrize(("speed", "direction"), [(0.0, 0.0), (0.3, 0.7)])
def test_sensitivity_and_poles_are_those_of_python_control(speed: float, direction: float) -> None:
    loop = loop_of(cross_drive(), speed, direction, dead_time=0.0)
    known = sensitivity_by_python_control(loop)
    expected: Array = np.moveaxis(known.frequency_response(OMEGA).complex, -1, 0)
    assert np.abs(loop.sensitivity(OMEGA) - expected).max() < 1e-9
    poles, own = known.poles(), loop.closed_loop_poles
    assert len(poles) == len(own)
    distance = np.abs(poles[:, None] - own[None]).min(axis=1)
    assert distance.max() < 1e-6  # of nearly double poles: the root of rounding


def test_the_dead_time_tolerated_is_that_of_the_loop_nearest_to_it() -> None:
    """In still water surge, sway and yaw of this craft are apart: the delay margin of each by python-control."""
    loop = loop_of(cross_drive())
    own, g, least = loop.craft, loop.gains, math.inf
    for i in range(3):
        M, D, lag = own.inertia[i, i], own.damping[i, i], g.lag[i]
        pid = control.tf([g.KP[i, i]], [1.0]) + control.tf([g.KI[i, i]], [1.0, 0.0])
        pid += control.tf([g.KD[i, i], 0.0], [lag, 1.0])
        open_loop = pid * control.tf([1.0], [own.lags[0], 1.0]) * control.tf([1.0], [M, D, 0.0])
        _, phase, _, _, crossover, _ = control.stability_margins(open_loop)
        least = min(least, math.radians(phase) / crossover)
    assert loop.tolerated_dead_time == pytest.approx(least, rel=1e-6)


def test_a_loop_at_the_dead_time_tolerated_is_about_to_swing() -> None:
    loop = loop_of(cross_drive(), 0.3, 0.7)
    late = loop_of(cross_drive(), 0.3, 0.7, dead_time=loop.tolerated_dead_time)
    omega = np.geomspace(0.1, 10.0, 20_000)
    assert np.abs(np.linalg.det(np.eye(3) + late.open_loop(omega))).min() < 2e-3
    assert loop.is_stable
    assert not loop_of(cross_drive(), 0.3, 0.7, dead_time=1.01 * loop.tolerated_dead_time).is_stable


def test_peaks_are_the_largest_of_the_sensitivity() -> None:
    loop = loop_of(cross_drive(), 0.3, 0.7)
    S = loop.sensitivity(loop.frequencies)
    arm = np.diag([1.0, 1.0, 0.6])
    expected = max(float(np.linalg.svd(arm @ one @ np.linalg.inv(arm))[1][0]) for one in S)
    assert loop.peaks()[3] == pytest.approx(expected, rel=1e-12)
    assert loop.peaks()[:3] == pytest.approx(np.abs(np.diagonal(S, axis1=1, axis2=2)).max(axis=0))


def test_a_loop_too_slow_for_the_current_has_no_peak() -> None:
    """In 0.3 m/s from ahead the water's moment turns the craft faster than a slow controller."""
    own = craft(cross_drive())
    slow = place_poles(own.inertia, own.damping, np.array([0.1, 0.1, 0.1]))
    loop = loop_of(cross_drive(), 0.3)
    assert np.isinf(StationLoop(loop.point, slow, loop.inverse, 0.1, loop.slope, OMEGA).peaks()).all()
