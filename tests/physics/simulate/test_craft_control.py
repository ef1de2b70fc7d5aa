"""A craft on station and a step of heading: held exactly, within limits, to the right side."""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from tests.control.station.station_cases import craft, cross_drive

from seatrial.control.station.craft import StationCraft, current_force, generalised_inverse
from seatrial.control.station.station_loop import StationLoop, place_poles, station_point
from seatrial.control.station.trial import sampled_controller
from seatrial.core.equations import Model
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import HeadingStep
from seatrial.physics.simulate.craft_control import StationRun, filter_coefficients, keep_station


def run_of(own: StationCraft, speed: float, forces: tuple[float, float, float], count: int, omega: float) -> StationRun:
    """Return the run of a craft in a current from ahead that begins at once, and steady forces."""
    gains = place_poles(own.inertia, own.damping, np.array([omega, omega, 1.5 * omega]))
    loop = StationLoop(station_point(own, 0.0, 0.0, generalised_inverse(own)), gains, generalised_inverse(own), 0.1,
                       np.ones(len(own.owner)), np.ones(1))  # fmt: skip
    controller = sampled_controller(loop, Sampling(0.1, 0.1))
    drift = np.stack([-speed * controller.dt * np.arange(count), np.zeros(count)])
    pushed = np.tile(np.array(forces)[:, None], count)
    return keep_station(own.pushed_model, controller, own.resting_inputs, np.concatenate([drift, pushed]))


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


K, T, DT = 0.2, 5.0, 0.25
GAINS = np.array([0.8, 3.0])


def ship() -> Model:
    return nomoto().with_values({"K": K, "T": T})


def test_a_linear_ship_follows_the_exactly_sampled_loop() -> None:
    step = HeadingStep(0.1, math.inf, "delta", 60.0, DT)
    model = ship()
    motion = step.simulate(model, GAINS, np.zeros(len(model.states)), np.zeros(len(model.inputs)))
    assert motion is not None
    # psi' = r, T r' + r = K delta (Nomoto 1957), delta held: exact by the exponential of the augmented matrix
    over = expm(DT * np.array([[0.0, 1.0, 0.0], [0.0, -1.0 / T, K / T], [0.0, 0.0, 0.0]]))
    x, expected = np.zeros(2), []
    for _ in range(len(motion[0])):
        expected.append(x)
        x = (over @ [*x, GAINS[0] * (0.1 - x[0]) - GAINS[1] * x[1]])[:2]
    places = [model.states.index("psi"), model.states.index("r")]
    assert motion[0][:, places] == pytest.approx(np.array(expected), abs=1e-8)


def test_the_actuator_keeps_its_limit_and_turns_the_craft_to_the_ordered_side() -> None:
    craft, limit = waterjet(), math.radians(35.0)
    start = np.zeros(len(craft.states))
    start[craft.states.index("u")] = 0.8
    for change in (0.5, -0.5):
        step = HeadingStep(change, limit, "delta", 120.0, DT)
        motion = step.simulate(craft, np.array([3.0, 20.0]), start, np.array([0.0, 1.866]))
        assert motion is not None
        assert motion[0][-1, craft.states.index("psi")] == pytest.approx(change, rel=0.02)  # band of settling
        assert np.max(np.abs(motion[1][:, 0])) == pytest.approx(limit)
        # positive nozzle angles of this model turn to port
        assert motion[1][0, 0] * change < 0.0


def test_a_craft_that_runs_away_has_no_motion() -> None:
    step = HeadingStep(0.1, math.inf, "delta", 4000.0, DT)
    model = ship()
    assert step.simulate(model, -10.0 * GAINS, np.zeros(len(model.states)), np.zeros(len(model.inputs))) is None
