"""Runs and their sensitivities by Runge-Kutta, splines, sines."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numba import njit
from scipy.interpolate import CubicSpline
from scipy.linalg import expm
from tests.numerics.kernels.case import KernelCase

from seatrial.core.equations import Model, Sheet
from seatrial.numerics.kernels.feedback import steer
from seatrial.numerics.kernels.integrate import DELAY, correct, latest_slopes, sincos, spline_points, spline_slopes
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE

# The integrator against the matrix exponential, and what it does at the edges.

K, C, B = 1.5, 0.3, 0.8


def exact(start: np.ndarray, u: np.ndarray, time: np.ndarray) -> np.ndarray:
    """States under an input that runs linearly over the whole time: the system augmented by u and its slope."""
    slope = (u[-1] - u[0]) / (time[-1] - time[0])
    a = np.array([[0, 1, 0, 0], [-K, -C, B, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    begin = np.array([*start, u[0], slope])
    return np.array([(expm(a * t) @ begin)[:2] for t in time])


def ramp(model: Model, steps: int, substeps: int = 1) -> tuple[KernelCase, np.ndarray]:
    time = np.linspace(0.0, 8.0, steps + 1)
    inputs = np.ascontiguousarray((0.2 + 0.1 * time)[:, None])
    start = np.array([[0.4, -0.2]])
    case = KernelCase(model, inputs, (0, steps + 1), 8.0 / steps, start, model.parameters.values[None], substeps)
    return case, exact(start[0], inputs[:, 0], time)


def test_error_falls_with_the_fourth_power_of_the_step(oscillator: Model) -> None:
    errors = []
    for steps in (40, 80, 160, 320):
        case, truth = ramp(oscillator, steps)
        errors.append(np.abs(case.run()[0][:, :2] - truth).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 4.0, atol=0.15)


def test_substeps_are_smaller_steps(oscillator: Model) -> None:
    coarse, fine = ramp(oscillator, 40, substeps=4)[0].run()[0], ramp(oscillator, 160)[0].run()[0]
    np.testing.assert_allclose(coarse, fine[::4], rtol=1e-12, atol=1e-13)


def test_outputs_are_taken_at_the_sample(oscillator: Model) -> None:
    case, truth = ramp(oscillator, 320)
    y = case.run()[0]
    np.testing.assert_allclose(y[:, 2], B * case.inputs[:, 0] - K * truth[:, 0] - C * truth[:, 1], atol=1e-8)


def test_segments_do_not_touch_one_another(nonlinear: Model, rng: np.random.Generator) -> None:
    inputs, start = rng.uniform(0.2, 0.8, (50, 2)), rng.normal(size=(3, 2))
    p = nonlinear.parameters.values * rng.uniform(0.9, 1.1, (3, 3))
    cuts = (0, 10, 35, 50)
    together = KernelCase(nonlinear, inputs, cuts, 0.1, start, p).run()[0]
    for i in range(3):
        part = np.ascontiguousarray(inputs[cuts[i] : cuts[i + 1]])
        alone = KernelCase(nonlinear, part, (0, len(part)), 0.1, start[i : i + 1], p[i : i + 1]).run()[0]
        np.testing.assert_array_equal(together[cuts[i] : cuts[i + 1]], alone)


def test_corrections_act_on_the_input(oscillator: Model) -> None:
    """Gain and offset scale and shift it; a delay of whole samples shifts the record, clamped to its first value."""
    case, _ = ramp(oscillator, 80)
    shifted = np.concatenate([np.repeat(case.inputs[:1], 3, axis=0), case.inputs[:-3]])
    corrected = KernelCase(
        oscillator, case.inputs, case.offsets, case.dt, case.start, case.p, 1, (1.3,), (-0.05,), (3 * case.dt,)
    )
    by_hand = KernelCase(oscillator, 1.3 * shifted - 0.05, case.offsets, case.dt, case.start, case.p)
    np.testing.assert_allclose(corrected.run()[0], by_hand.run()[0], rtol=1e-12, atol=1e-12)


def test_divergence_is_flagged_with_its_sample_and_nan_fills_the_rest(explosive: Model) -> None:
    inputs = np.zeros((80, 1))
    start = np.array([[0.1], [1.0]])
    y, failed = KernelCase(explosive, inputs, (0, 40, 80), 0.1, start, np.ones((2, 1))).run()
    assert failed[0] == -1
    assert np.isfinite(y[:40]).all()
    assert 10 <= failed[1] <= 14, "1 / (1 - t) leaves all bounds at t = 1"
    assert np.isfinite(y[40 : 40 + failed[1]]).all()
    assert np.isnan(y[40 + failed[1] :]).all()


def test_a_segment_of_one_sample_is_its_start(oscillator: Model) -> None:
    case = KernelCase(
        oscillator, np.zeros((1, 1)), (0, 1), 0.1, np.array([[0.4, -0.2]]), oscillator.parameters.values[None]
    )
    y, failed = case.run()
    np.testing.assert_allclose(y[0, :2], [0.4, -0.2])
    assert failed[0] == -1


@njit(COMMAND_SIGNATURE)
def _alternate(t, x, memory, u):  # noqa: ARG001
    """A bang-bang helmsman: +-memory[0] against the sign of x; memory[1] counts the calls."""
    memory[1] += 1.0
    u[0] = -memory[0] if x[0] > 0.0 else memory[0]


def test_a_command_is_called_once_a_step_and_held_over_it(oscillator: Model) -> None:
    steps, dt = 60, 0.05
    x_out, u_out, memory = np.empty((steps, 2)), np.empty((steps, 1)), np.array([0.5, 0.0])
    p = oscillator.parameters.values
    row = steer(oscillator.compiled.rates, _alternate, np.array([0.4, -0.2]), np.zeros(1), p, memory, dt, x_out, u_out)
    assert row == -1
    assert memory[1] == steps
    a = np.array([[0, 1, 0], [-K, -C, B], [0, 0, 0]])
    hold = expm(a * dt)
    for k in range(steps - 1):
        assert u_out[k, 0] == (-0.5 if x_out[k, 0] > 0 else 0.5)
        np.testing.assert_allclose(x_out[k + 1], (hold @ [*x_out[k], u_out[k, 0]])[:2], atol=1e-8)


def test_a_diverging_loop_says_when(explosive: Model) -> None:
    x_out, u_out = np.full((80, 1), np.nan), np.full((80, 1), np.nan)
    row = steer(
        explosive.compiled.rates, _alternate, np.ones(1), np.zeros(1), np.ones(1), np.zeros(2), 0.1, x_out, u_out
    )
    assert 10 <= row <= 14
    assert np.isfinite(x_out[:row]).all()


@pytest.mark.parametrize("which", ["replay", "steer"])
def test_both_ways_agree_on_a_constant_input(nonlinear: Model, which: str) -> None:
    inputs = np.tile([0.3, 0.9], (30, 1))
    start, p = np.array([[0.2, 0.1]]), nonlinear.parameters.values[None]
    y = KernelCase(nonlinear, inputs, (0, 30), 0.1, start, p).run()[0][:, :2]
    x_out, u_out = np.empty((30, 2)), np.empty((30, 2))
    steer(nonlinear.compiled.rates, _idle, start[0], inputs[0].copy(), p[0], np.zeros(1), 0.1, x_out, u_out)
    np.testing.assert_allclose({"replay": y, "steer": x_out}[which], y, rtol=1e-13)


@njit(COMMAND_SIGNATURE)
def _idle(t, x, memory, u):
    """Leaves the input as it is."""


def test_a_delayed_parabola_is_itself_earlier_and_its_slope_is_exact() -> None:
    """Cubic convolution is exact for parabolas, also between samples; at the ends it is clamped."""
    dt, delay = 0.5, np.array([0.3])
    time = dt * np.arange(12)
    inputs = (0.2 * time**2 - 0.4 * time)[:, None]
    made, weights = np.empty((12, 1)), np.empty((12, 3))
    correct(inputs, dt, np.ones(1), np.zeros(1), delay, made, weights)
    late = time - delay[0]
    np.testing.assert_allclose(made[2:-1, 0], (0.2 * late**2 - 0.4 * late)[2:-1], atol=1e-12)
    np.testing.assert_allclose(weights[2:-1, DELAY], -(0.4 * late - 0.4)[2:-1], atol=1e-12)
    assert made[0, 0] == inputs[0, 0] and weights[0, DELAY] == 0.0


def test_a_held_input_acts_at_once_and_whole() -> None:
    """One step of an integrator: the area of an order is its value times the time, none of the one that follows."""
    sheet = Sheet("integrator", "the sum of an input over time")
    (x,) = sheet.states("x")
    sheet.rate(x, sheet.parameter("k", 1.0) * sheet.input("force"), "x' = k force")
    case = KernelCase(sheet.model(), np.array([[1.0], [3.0], [3.0]]), (0, 3), 0.5, np.zeros((1, 1)), np.ones((1, 1)))
    np.testing.assert_allclose(replace(case, held=(0,)).run()[0][:, 0], [0.0, 0.5, 2.0])
    np.testing.assert_allclose(case.run()[0][:, 0], [0.0, 1.0, 2.5])


# Sensitivities against central differences of the computed trajectory, column by column.


def moved(case: KernelCase, kind: str, i: int, step: float) -> KernelCase:
    if kind in ("p", "start"):
        changed = getattr(case, kind).copy()
        changed[:, i] += step
        return replace(case, **{kind: changed})
    row = list(getattr(case, kind))
    row[i] += step
    return replace(case, **{kind: tuple(row)})


@pytest.fixture(scope="module")
def case(nonlinear: Model) -> KernelCase:
    rng = np.random.default_rng(5)
    inputs = np.array([0.2, 0.8]) + np.cumsum(rng.normal(0.0, 0.03, (60, 2)), axis=0)
    start = np.array([[0.3, -0.2], [0.5, 0.1]])
    p = nonlinear.parameters.values * np.array([[1.0, 1.0, 1.0], [1.1, 0.9, 1.05]])
    return KernelCase(nonlinear, inputs, (0, 25, 60), 0.1, start, p, 2, (1.1, 0.9), (0.03, -0.02), (0.037, 0.113))


def test_every_column_equals_central_differences(case: KernelCase) -> None:
    _, s, failed = case.run_tangent()
    assert (failed == -1).all()
    for k, (kind, i) in enumerate(case.columns()):
        step = 1e-6
        upper, lower = moved(case, kind, i, step).run()[0], moved(case, kind, i, -step).run()[0]
        differences = (upper - lower) / (2 * step)
        scale = np.abs(differences).max()
        assert scale > 1e-3, f"column {kind} {i} has no effect: the test would not see an error"
        np.testing.assert_allclose(s[:, :, k], differences, atol=2e-8 * max(scale, 1.0), err_msg=f"{kind} {i}")


def test_the_trajectory_is_the_plain_one(case: KernelCase) -> None:
    np.testing.assert_allclose(case.run_tangent()[0], case.run()[0], rtol=1e-13, atol=1e-14)


def test_initial_states_start_from_unity(case: KernelCase) -> None:
    s = case.run_tangent()[1]
    for first in case.offsets[:-1]:
        np.testing.assert_array_equal(s[first, :2, -2:], np.eye(2))
        np.testing.assert_array_equal(s[first, :2, :-2], 0.0)


def test_a_diverging_segment_is_flagged_and_the_next_one_is_not_harmed(explosive: Model) -> None:
    case = KernelCase(explosive, np.zeros((80, 1)), (0, 40, 80), 0.1, np.array([[1.0], [0.1]]), np.ones((2, 1)))
    y, s, failed = case.run_tangent()
    assert 10 <= failed[0] <= 14 and failed[1] == -1
    assert np.isnan(s[failed[0] : 40]).all() and np.isnan(y[failed[0] : 40]).all()
    assert np.isfinite(s[40:]).all() and np.isfinite(y[40:]).all()


# Slopes of a spline against scipy's.


@pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
def test_slopes_are_those_of_the_not_a_knot_spline(count: int, rng: np.random.Generator) -> None:
    u, place = rng.standard_normal((count, 3)), np.arange(count)
    np.testing.assert_allclose(spline_slopes(u), CubicSpline(place, u)(place, 1), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
def test_points_are_those_of_the_not_a_knot_spline(count: int, rng: np.random.Generator) -> None:
    u, place = rng.standard_normal((count, 3)), np.linspace(0.0, count - 1.0, 97)
    value, rise = spline_points(u, spline_slopes(u), place)
    exact = CubicSpline(np.arange(count), u)
    np.testing.assert_allclose(value, exact(place), rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(rise, exact(place, 1), rtol=1e-10, atol=1e-12)


def test_one_sample_has_no_slope() -> None:
    np.testing.assert_array_equal(spline_slopes(np.ones((1, 2))), [[0.0, 0.0]])


def test_latest_slopes_are_those_of_a_spline_that_ends_at_each_row(rng: np.random.Generator) -> None:
    u = rng.standard_normal((20, 2))
    latest = latest_slopes(u, 12)
    for row in range(1, 20):
        ended = spline_slopes(u[max(row - 12, 0) : row + 1])
        np.testing.assert_array_equal(latest[row], np.concatenate([ended[-2], ended[-1]]))
    value, rise = spline_points(np.ones((1, 2)), np.zeros((1, 2)), np.zeros(3))
    np.testing.assert_array_equal(value, np.ones((3, 2)))
    np.testing.assert_array_equal(rise, np.zeros((3, 2)))


def test_what_comes_later_is_felt_by_the_stated_factor(rng: np.random.Generator) -> None:
    u = rng.standard_normal((30, 1))
    bent = u.copy()
    bent[20:] += 1.0
    felt = np.abs(spline_slopes(bent) - spline_slopes(u))[:, 0]
    np.testing.assert_allclose(felt[12:18] / felt[13:19], 2.0 - np.sqrt(3.0), rtol=1e-6)


# Sine and cosine together agree with the C library to the last bits, in every quadrant.


def test_it_agrees_with_the_library(rng: np.random.Generator) -> None:
    for angle in np.concatenate([rng.uniform(-10.0, 10.0, 500), rng.uniform(-1e5, 1e5, 500)]):
        sine, cosine = sincos(angle)
        assert sine == pytest.approx(math.sin(angle), abs=3e-16)
        assert cosine == pytest.approx(math.cos(angle), abs=3e-16)


def test_zero_and_signs_are_exact() -> None:
    assert sincos(0.0) == (0.0, 1.0)
    for angle in (0.3, 1.2, 2.9, 6.0):
        assert sincos(-angle) == (-sincos(angle)[0], sincos(angle)[1])
