"""Objectives by hand and against the same criterion elsewhere; reversals and energy of an actuator."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import G
from seatrial.physics.loops import (
    ActuatorDrive,
    HullFactor,
    LiftingSurface,
    LoopSignal,
    Objective,
    Performance,
    reversals_per_hour,
    sea_disturbance,
)
from seatrial.physics.loops.objective import (
    hourly_energy,
    motion_interruptions,
    motion_sickness,
    motion_sickness_at,
    motion_sickness_dose,
    motion_sickness_weighting,
    squared_deviation,
    variance,
    vertical_acceleration,
)
from seatrial.physics.loops.performance import distinct_variances
from seatrial.physics.loops.structures import ROLL, fin_loop
from seatrial.physics.sea.spectrum import ittc
from seatrial.physics.sea.wave_forces import MotionStatistics
from seatrial.physics.sea.wave_forces import motion_sickness as sickness_of

OBJECTIVES = [
    variance("roll", "rad^2", LoopSignal.OUTPUT),
    variance("roll acceleration", "rad^2/s^4", LoopSignal.OUTPUT, 2),
    variance("fin rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
    squared_deviation("fin", LoopSignal.ACTUATOR, 0.02, one_sided=False),
    squared_deviation("fin above", LoopSignal.ACTUATOR, 0.02, one_sided=True),
    motion_interruptions(6.0),
    motion_sickness(8.0),
]
GAINS = np.array([11.053, 0.428, 32.736])


def performance(objective: Objective, height: float = 3.3) -> tuple[Performance, list[int]]:
    rows, places = distinct_variances((objective,))
    sea = sea_disturbance(ittc(height), 9.26, math.pi / 2.0, ROLL, HullFactor(100.0, 10.5, 3.4))
    return Performance(fin_loop(), sea, rows), places[0]


@pytest.mark.parametrize("objective", OBJECTIVES, ids=lambda objective: objective.name)
def test_slopes_over_variances_equal_differences(objective: Objective) -> None:
    made, place = performance(objective)
    v = made.evaluate(GAINS).variances[:, place]
    slope = objective.gradient(v)[0]
    assert slope.shape == (len(objective.variances),)
    for i in range(len(objective.variances)):
        step = np.eye(len(objective.variances))[i] * v[0, i] * 1e-6
        numeric = (objective.value(v + step) - objective.value(v - step))[0] / (2.0 * step[i])
        assert slope[i] == pytest.approx(numeric, rel=1e-6, abs=1e-9 * abs(slope).max())


@pytest.mark.parametrize("objective", OBJECTIVES, ids=lambda objective: objective.name)
def test_gradients_over_gains_equal_differences(objective: Objective) -> None:
    made, place = performance(objective)

    def value(k: Array) -> float:
        return float(objective.value(made.evaluate(k).variances[:, place])[0])

    gradient = objective.gradient(made.evaluate(GAINS).variances[:, place])[0] @ made.variance_gradients(GAINS)[place]
    h = 1e-4
    numeric = [(value(GAINS + h * e) - value(GAINS - h * e)) / (2.0 * h) for e in np.eye(3)]
    np.testing.assert_allclose(gradient, numeric, rtol=1e-5, atol=1e-7 * np.abs(gradient).max() + 1e-30)


@pytest.mark.parametrize("objective", OBJECTIVES, ids=lambda objective: objective.name)
def test_an_unstable_loop_is_infinitely_bad(objective: Objective) -> None:
    made, place = performance(objective)
    assert objective.value(made.evaluate(np.array([100.0, 50.0, 0.0]) * 100.0).variances[:, place])[0] == np.inf


def test_variances_of_rate_and_acceleration_weigh_by_powers_of_the_frequency() -> None:
    omega = np.array([0.5, 2.0])
    assert [variance("v", "", LoopSignal.OUTPUT, n).variances[0].magnitude(omega).tolist() for n in (0, 1, 2)] == [
        [1.0, 1.0], [0.5, 2.0], [0.25, 4.0]
    ]  # fmt: skip


def test_the_printed_objective_rewards_motion_below_its_target_and_the_one_sided_does_not() -> None:
    printed, hinge = (squared_deviation("fin", LoopSignal.ACTUATOR, 3.0, one_sided=one) for one in (False, True))
    v = np.array([[1.0], [3.0], [5.0]])
    assert printed.value(v).tolist() == [4.0, 0.0, 4.0]
    assert printed.gradient(v).tolist() == [[-4.0], [0.0], [4.0]]
    assert hinge.value(v).tolist() == [0.0, 0.0, 4.0]
    assert hinge.gradient(v).tolist() == [[0.0], [0.0], [4.0]]


def test_interruptions_equal_the_formula_by_hand() -> None:
    # rms lateral force estimator 1 m/s^2, mean frequency 1 rad/s, half stance over height .25
    of = motion_interruptions(5.0)
    by_hand = 60.0 / math.pi * math.exp(-0.5 * (0.25 * G) ** 2)
    assert of.value(np.array([[1.0, 1.0]]))[0] == pytest.approx(by_hand, rel=1e-12)
    assert by_hand == pytest.approx(0.94, abs=0.01)
    omega = np.array([0.8])
    assert of.variances[0].magnitude(omega)[0] == pytest.approx(G + 5.0 * 0.64)
    assert of.variances[1].magnitude(omega)[0] == pytest.approx(0.8 * (G + 5.0 * 0.64))


def test_interruptions_are_crossings_of_a_gaussian_record_counted() -> None:
    rng = np.random.default_rng(4)
    w, dt = np.linspace(0.5, 1.5, 400), 0.05
    size = np.exp(-(((w - 0.9) / 0.15) ** 2))
    size *= 1.6 / math.sqrt(0.5 * np.sum(size**2))
    t = np.arange(0.0, 2400.0, dt)
    lateral = np.zeros_like(t)
    for a, o, phase in zip(size, w, rng.uniform(0.0, 2.0 * math.pi, 400), strict=True):
        lateral += a * np.cos(o * t + phase)
    beyond = np.abs(lateral) > 0.25 * G
    counted = np.count_nonzero(beyond[1:] & ~beyond[:-1]) / (t[-1] / 60.0)
    v = np.array([[0.5 * np.sum(size**2), 0.5 * np.sum((w * size) ** 2)]])
    assert motion_interruptions(5.0).value(v)[0] == pytest.approx(counted, rel=0.12)


def test_sickness_equals_that_of_the_same_motion_elsewhere() -> None:
    lever, of = 12.0, motion_sickness(12.0)
    made, place = performance(of, 6.0)
    w = made.spectrum.omega_e
    motion = (
        np.abs(lever * made.loop.disturbance.frequency_response(w) / (1.0 + made.loop.with_gains(GAINS).open_loop(w)))
        ** 2
    )
    moments = [float(np.sum(w**n * motion * made.spectrum.energy)) for n in (0, 2, 4)]
    value = of.value(made.evaluate(GAINS).variances[:, place])[0]
    assert value == pytest.approx(sickness_of(MotionStatistics(*moments)), rel=1e-9)
    assert 1e-4 < value < 0.5


def test_sickness_does_not_ask_on_which_side_one_stands() -> None:
    omega = np.array([0.7])
    port, starboard = motion_sickness(-4.0), motion_sickness(4.0)
    assert port.variances[1].magnitude(omega) == starboard.variances[1].magnitude(omega) == pytest.approx(4.0 * 0.49)


def test_the_weighting_of_motion_sickness_is_the_tabulated_one() -> None:
    """ISO 2631-1:1997, table 3, W_f in thousandths at nominal third-octave centres [Hz]."""
    table = {0.1: 695, 0.125: 895, 0.16: 1006, 0.2: 992, 0.25: 854, 0.315: 619, 0.4: 384, 0.5: 224, 0.63: 116}
    got = 1000.0 * motion_sickness_weighting(2.0 * math.pi * np.array([*table]))
    np.testing.assert_allclose(got, [*table.values()], atol=0.6)


def test_sickness_of_a_point_is_the_criterion_of_sea_response() -> None:
    v = np.array([[0.4, 0.9]])
    assert motion_sickness_at(20.0).value(v)[0] == pytest.approx(sickness_of(MotionStatistics(0.2, 0.4, 0.9)))


def test_a_dose_grows_with_the_root_of_the_time() -> None:
    v = np.array([[0.25]])
    assert motion_sickness_dose(20.0, 7200.0).value(v)[0] == pytest.approx(0.5 * math.sqrt(7200.0))
    assert vertical_acceleration(20.0).value(v)[0] == 0.25


def test_a_harmonic_turns_back_twice_a_period() -> None:
    omega = 0.8
    assert reversals_per_hour(omega, omega**2) == pytest.approx(2.0 * 3600.0 * omega / (2.0 * math.pi))


def test_a_reversal_costs_the_kinetic_energy_of_its_peak_over_the_efficiency() -> None:
    peak = 0.3
    assert ActuatorDrive(800.0, 0.8).energy(peak**2 / 2.0) == pytest.approx(0.5 * 800.0 * peak**2 / 0.8)


def test_a_rate_that_rises_in_steps_takes_the_work_of_each() -> None:
    # up to 2, back to 1, up to 3, over to -2 and down to rest: 4 + (9 - 1) + 4
    made = ActuatorDrive(10.0, 0.5).hourly_energy(np.array([0.0, 2.0, 1.0, 3.0, -2.0, -1.0]), 0.5)
    assert made == pytest.approx(0.5 * 10.0 * 16.0 / 0.5 * 3600.0 / 3.0)


def test_the_energy_of_a_swinging_drive_is_that_of_its_reversals() -> None:
    drive, dt, omega, amplitude = ActuatorDrive(800.0, 0.8), 0.01, 2.0 * math.pi / 8.0, 0.2
    rates = amplitude * omega * np.sin(omega * dt * np.arange(1 + round(3600.0 / dt)))
    reversals = 2.0 * 3600.0 * omega / (2.0 * math.pi)
    peak = amplitude * omega
    assert drive.hourly_energy(rates, dt) == pytest.approx(reversals * 0.5 * 800.0 * peak**2 / 0.8, rel=1e-3)


def test_the_drag_of_fins_is_that_of_whicker_and_fehlner() -> None:
    """Aspect ratio 3: slope 1.8 pi 3 / (1.8 + sqrt(13)) = 3.13836 a radian, by hand."""
    surface = LiftingSurface(5.0, 3.0)
    rise = 3.13836**2 / (0.9 * math.pi * 3.0)
    by_hand = 0.5 * 1025.0 * 8.0**3 * 5.0 * rise * 0.02 * 3600.0
    assert surface.hourly_energy(0.02, 8.0) == pytest.approx(by_hand, rel=1e-4)
    assert surface.hourly_energy(0.02, 16.0) == pytest.approx(8.0 * by_hand, rel=1e-4)


def test_the_energy_objective_adds_drive_and_drag_and_knows_its_slopes() -> None:
    drive, surface = ActuatorDrive(800.0, 0.8), LiftingSurface(5.0, 3.0)
    both, v = hourly_energy(drive, surface, 8.0), np.array([[0.02, 0.01, 0.03]])
    turned = drive.energy(0.01) * reversals_per_hour(math.sqrt(0.01), math.sqrt(0.03))
    assert both.value(v)[0] == pytest.approx(turned + surface.hourly_energy(0.02, 8.0))
    steps = 1e-6 * np.eye(3)
    differences = [(both.value(v + s)[0] - both.value(v - s)[0]) / 2e-6 for s in steps]
    np.testing.assert_allclose(both.gradient(v)[0], differences, rtol=1e-6)
    assert both.value(np.zeros((1, 3)))[0] == 0.0
    assert np.all(np.isfinite(both.gradient(np.zeros((1, 3)))))
