"""A craft on station: a steady current and a steady force are held exactly, limits keep the direction of the force."""

import numpy as np
import pytest
from tests.control.station.station_cases import craft, cross_drive

from seatrial.control.station.craft import StationCraft, current_force, generalised_inverse
from seatrial.control.station.station_loop import StationLoop, place_poles, station_point
from seatrial.control.station.trial import sampled_controller
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.simulate.craft_control import StationRun, filter_coefficients, keep_station


def run_of(own: StationCraft, speed: float, forces: tuple[float, float, float], count: int, omega: float) -> StationRun:
    """Return the run of a craft in a current from ahead that begins at once, and steady forces."""
    gains = place_poles(own.inertia, own.damping, np.array([omega, omega, 1.5 * omega]))
    loop = StationLoop(station_point(own, 0.0, 0.0, generalised_inverse(own)), gains, generalised_inverse(own), 0.1,
                       np.ones(len(own.owner)), np.ones(1))  # fmt: skip
    controller = sampled_controller(loop, Sampling(0.1, 0.1))
    drift = np.stack([-speed * controller.dt * np.arange(count), np.zeros(count)])
    pushed = np.tile(np.array(forces)[:, None], count)
    return keep_station(own.pushed_model, controller, own.resting_inputs, drift, pushed)


def test_the_integral_removes_a_steady_current_and_force() -> None:
    """In the end the craft is at its station and the thrusters balance hull and force: B T = drag - force."""
    own, speed, force = craft(cross_drive()), 0.3, (4.0, -9.0, 2.0)
    run = run_of(own, speed, force, 20_000, 0.5)
    assert max(abs(run.north[-1]), abs(run.east[-1]), abs(run.heading[-1])) < 1e-6
    assert run.given[-1] == 1.0
    expected = generalised_inverse(own) @ (-current_force(own, speed, 0.0) - np.array(force))
    assert run.thrust[-1] == pytest.approx(expected, rel=5e-4)  # of the table by which a thrust becomes a command


def test_a_dead_band_is_jumped() -> None:
    """The least thrust needs a command beyond the band; a steady current is held as exactly as without it."""
    own = craft(cross_drive().with_values({"dead": 0.1}))
    table = own.tables[0]
    assert np.interp([-0.01, 0.01], table.thrust, table.share) == pytest.approx([-0.1, 0.1], abs=0.02)
    run = run_of(own, 0.3, (4.0, -9.0, 2.0), 20_000, 0.5)
    assert max(abs(run.north[-1]), abs(run.east[-1]), abs(run.heading[-1])) < 1e-6


def test_limits_cut_all_thrusts_alike() -> None:
    """A force beyond the limits: one thruster gives all it has, the others as much less of what they were ordered."""
    own = craft(cross_drive())
    run = run_of(own, 0.0, (-400.0, 50.0, 0.0), 200, 0.5)
    cut = int(np.argmax(run.given < 1.0))
    assert 0.0 < run.given[cut] < 1.0
    assert np.max(run.thrust[cut]) == pytest.approx(own.tables[0].most)
    assert np.all(run.thrust <= own.tables[0].most + 1e-9)


def test_the_filter_is_a_difference_behind_a_lag() -> None:
    """A ramp of 1 m/s ends at 1 m/s; the pole of a long lag is exp(-h / lag) to second order."""
    past, forward = filter_coefficients(np.full(3, 0.5), 0.01)
    assert forward * 0.01 / (1.0 - past) == pytest.approx(np.ones(3))
    assert past == pytest.approx(np.full(3, np.exp(-0.02)), rel=1e-5)
