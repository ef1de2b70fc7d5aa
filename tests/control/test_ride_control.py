"""Fins on heave and pitch in waves: against the equations solved as a matrix, and against a simulation."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.control.loop_files import (
    FIN,
    RIDE_CONTROL,
    heave_and_pitch,
    heave_pitch_file,
    in_continuous_time,
    model_file,
    nomoto,
    write_loop_file,
)

from seatrial.control.controller import components
from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.loopfile.load import tuning_task
from seatrial.control.simulation import simulate_in_seaway
from seatrial.control.task import Seaway, SimulationSettings, TuningTask
from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.capytaine_data import HullExcitation, read_capytaine
from seatrial.physics.hydro.excitation import BoxHull, Complex, Excitation, G
from seatrial.physics.loops.objective import motion_sickness_weighting
from seatrial.physics.sea.wave_forces import MotionStatistics, motion_sickness

OBJECTIVES = '[{ name = "vertical_acceleration", x = 20 }, "actuator_rate"]'
ALL_OBJECTIVES = (
    '[{ name = "vertical_acceleration", x = 20 }, "actuator_rate", { name = "motion_sickness", x = 20 }, '
    '{ name = "motion_sickness_dose", x = -10, duration = 3600 }, "output", "output_acceleration", "actuator"]'
)
GAINS = np.array([20.0, 30.0])
U = 18.0 * 1852.0 / 3600.0


def ride(folder: Path, *changes: tuple[str, str]) -> TuningTask:
    heave_pitch_file(folder)
    return tuning_task(write_loop_file(folder, RIDE_CONTROL, *changes))


@pytest.fixture
def task(tmp_path: Path) -> TuningTask:
    return ride(tmp_path)


class Motions:
    """Heave [m, up], pitch [rad, bow down] and fin [rad] under each wave of the sea, with the loop closed.

    The two equations of motion as Qi et al. 2025 print them, with the box's forces and the fin's lift, solved at each
    frequency with the controller written out: nothing of the loops' code.
    """

    def __init__(self, gains: Array, heading: float = 135.0, count: int = 40_001) -> None:
        v = {p.name: p.value for p in heave_and_pitch().parameters}
        M = np.array([[v["m"] + v["a33"], v["a35"]], [v["a53"], v["I5"] + v["a55"]]])
        B = np.array([[v["b33"], v["b35"]], [v["b53"], v["b55"]]])
        C = np.array([[v["c33"], v["c35"]], [v["c53"], v["c55"]]])
        edges, beta = np.linspace(0.25, math.sqrt(G / 2.27), count), math.radians(heading)
        omega = 0.5 * (edges[1:] + edges[:-1])
        self.energy = 8.1e-3 * G**2 / omega**5 * np.exp(-3.11 / 1.5**2 / omega**4) * np.diff(edges)
        self.omega_e = omega - omega**2 / G * U * math.cos(beta)
        s = 1j * self.omega_e
        F = np.stack(BoxHull(60.0, 7.137, 2.27, *C.ravel()).forces(omega, U, beta), axis=1)
        mechanics = -(self.omega_e**2)[:, None, None] * M + s[:, None, None] * B + C
        # a fin aft that lifts puts the bow down: it is to lift while the bow goes up
        K = (gains[0] + gains[1] * s / (0.1 * s + 1.0)) * 225.0 / (s**2 + 21.0 * s + 225.0)
        mechanics[:, :, 1] += K[:, None] * v["lift_1"] * np.array([1.0, -v["x_f1"]])
        self.heave, self.pitch = np.linalg.solve(mechanics, F[..., None])[..., 0].T
        self.fin = -K * self.pitch

    def at(self, x: float) -> Complex:
        return self.heave - x * self.pitch

    def variance(self, motion: Complex, power: int = 0) -> float:
        return float(np.sum(np.abs(motion * self.omega_e**power) ** 2 * self.energy))


@pytest.mark.parametrize("heading", [45.0, 90.0, 135.0, 180.0])
def test_every_objective_is_that_of_the_equations_of_motion(tmp_path: Path, heading: float) -> None:
    task = ride(tmp_path, ("value = 135", f"value = {heading}"), (OBJECTIVES, ALL_OBJECTIVES))
    got = gain_evaluator(in_continuous_time(task)).objective_values(GAINS[None])[0]
    sea = Motions(GAINS, heading)
    forward = MotionStatistics(*(sea.variance(sea.at(20.0), power) for power in (0, 1, 2)))
    weighted = sea.variance(sea.at(-10.0) * motion_sickness_weighting(np.abs(sea.omega_e)), 2)
    expected = [
        forward.m4, sea.variance(sea.fin, 1), motion_sickness(forward), math.sqrt(3600.0 * weighted),
        sea.variance(sea.pitch), sea.variance(sea.pitch, 2), sea.variance(sea.fin),
    ]  # fmt: skip
    np.testing.assert_allclose(got, expected, rtol=1e-6)


def test_without_control_the_motion_is_the_hull_s_own(task: TuningTask) -> None:
    still = Motions(np.zeros(2))
    free = gain_evaluator(task).uncontrolled_variance
    assert free == pytest.approx(still.variance(still.at(20.0), 2), rel=1e-7)


def test_gradients_equal_differences(tmp_path: Path) -> None:
    evaluator = gain_evaluator(ride(tmp_path, (OBJECTIVES, ALL_OBJECTIVES)))
    slopes, _ = evaluator.point(GAINS).slopes
    for i, step in enumerate(np.diag(1e-5 * GAINS)):
        up, down = evaluator.objective_values(np.array([GAINS + step, GAINS - step]))
        np.testing.assert_allclose(slopes[:, i], (up - down) / (2.0 * step[i]), rtol=1e-5)


def test_simulated_seas_have_the_reduction_of_linear_theory(task: TuningTask) -> None:
    """Ten seas of 300 s: of waves and fin in time, second differences at the point."""
    few = replace(task, simulation=SimulationSettings(10, 300.0, 0.05))
    run = simulate_in_seaway(few, few.loop, "some gains", GAINS, seed=0)
    evaluator = gain_evaluator(task)
    left = math.sqrt(evaluator.evaluate(GAINS[None]).variances[0, 0, 3] / evaluator.uncontrolled_variance)
    spread = run.linear.std(ddof=1) / math.sqrt(10.0)
    assert abs(run.linear.mean() - (1.0 - left)) < 3.0 * spread + 2e-3
    assert spread < 0.01
    assert np.all(run.limited < run.linear)
    assert {"motion", "motion_uncontrolled", "theta", "theta_uncontrolled", "delta_f1"} == set(run.record.channels)


def tabulated(folder: Path, excitation: Excitation, heading: float) -> TuningTask:
    """The loop in forces that a table has of an excitation."""
    omega = np.linspace(0.25, 2.08, 300)
    F3, M5 = excitation.forces(omega, U, math.radians(heading))
    rows = np.column_stack([omega, np.full(300, heading), F3.real, F3.imag, M5.real, M5.imag])
    head = "omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag"
    np.savetxt(folder / "forces.csv", rows, delimiter=",", header=head, comments="")
    source = ('source = "box"', 'source = "table"\nfile = "forces.csv"')
    return ride(folder, source, ("value = 135", f"value = {heading}"))


def test_a_table_of_the_same_forces_gives_the_same_loop(tmp_path: Path, task: TuningTask) -> None:
    v = {p.name: p.value for p in heave_and_pitch().parameters}
    box = BoxHull(60.0, 7.137, 2.27, v["c33"], v["c35"], v["c53"], v["c55"])
    pair = (gain_evaluator(each).evaluate(GAINS[None]).variances for each in (task, tabulated(tmp_path, box, 135.0)))
    np.testing.assert_allclose(*pair, rtol=2e-4)


def test_forces_of_a_panel_code_give_the_loop_of_their_table(tmp_path: Path) -> None:
    """A dataset of Capytaine at rest, speed terms by strip theory, against the same forces written out."""
    pytest.importorskip("xarray", reason="xarray is not installed (extra hydro)")
    from tests.physics.hydro.test_capytaine_data import capytaine_dataset

    hull = capytaine_dataset(np.linspace(0.25, 2.08, 60))
    hull["Froude_Krylov_force"] = 3.15e6 * hull["Froude_Krylov_force"]
    hull.to_netcdf(tmp_path / "hull.nc")
    source = ('source = "box"', 'source = "capytaine"\nfile = "hull.nc"')
    task = ride(tmp_path, source, ("value = 135", "value = 180"))
    panels = HullExcitation(read_capytaine(tmp_path / "hull.nc"))
    pair = (gain_evaluator(each).evaluate(GAINS[None]).variances for each in (task, tabulated(tmp_path, panels, 180.0)))
    np.testing.assert_allclose(*pair, rtol=5e-4)


def test_the_sea_says_what_it_moves(task: TuningTask) -> None:
    sea = task.disturbances[0]
    assert isinstance(sea, Seaway)
    assert sea.is_output
    assert sea.description.endswith("by the motion of the hull")
    assert task.motion.name == "variance of the vertical acceleration at 20 m"


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([('[excitation]\nsource = "box"\n', "")], "by the forces F3 and M5; add [excitation]"),
        ([('output = "theta"', 'output = "z_dot"')], 'seas: give plant.output = "theta" or "z"'),
        ([("[[seas]]", '[[seas]]\nspeed = { value = 12, unit = "kn" }')], "seas[1].speed: the coefficients of heave"),
        ([("height = 1.5", "height = 0.8")], "seas[1]: the forces of waves are known from 0 to 2.08 rad/s"),
        ([("x = 20", "height = 20")], "'vertical_acceleration' knows no 'height'"),
        ([(", x = 20", "")], "'vertical_acceleration' needs x in metres"),
        (
            [("[[seas]]", "[schedule]\nspeeds = [9.26, 7]\nheadings = [2.356]\nheights = [1.5]\n[[seas]]")],
            "schedule.speeds: the coefficients of heave and pitch hold at 9.26 m/s",
        ),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, changes: list[tuple[str, str]], says: str) -> None:
    with pytest.raises(InputError) as error:
        ride(tmp_path, *changes)
    assert says in str(error.value)


def test_a_place_goes_with_heave_and_pitch(tmp_path: Path) -> None:
    line = ("[plant]", f"minimise = {OBJECTIVES}\n[plant]")
    with pytest.raises(InputError, match="minimise: 'x' goes with a model of heave and pitch"):
        tuning_task(write_loop_file(tmp_path, FIN, line))
    both = ("[plant]", 'minimise = [{ name = "motion_sickness", x = 2, lever = 3 }, "fin_rate"]\n[plant]')
    with pytest.raises(InputError, match=r"needs lever \(of roll\) or x"):
        tuning_task(write_loop_file(tmp_path, FIN, both))


def test_speeds_in_waves_are_refused_as_before(tmp_path: Path) -> None:
    model_file(tmp_path, nomoto())
    text = (
        RIDE_CONTROL.replace('speed = { value = 18, unit = "kn" }\n', "")
        .replace("theta", "r")
        .replace("delta_f1", "delta")
        .replace(OBJECTIVES, '["output"]')
    )
    with pytest.raises(InputError, match="waves reach roll, heading, and heave and pitch"):
        tuning_task(write_loop_file(tmp_path, text.replace('[excitation]\nsource = "box"\n', "")))


def test_the_loop_shows_waves_as_motion_of_the_hull(task: TuningTask) -> None:
    shown = components(task.disturbances[0].disturbed(task.loop))
    assert (shown[-1].role, shown[-1].name, shown[-1].num, shown[-1].den) == (
        "disturbance", "motion of the hull", (1.0,), (1.0,),
    )  # fmt: skip
