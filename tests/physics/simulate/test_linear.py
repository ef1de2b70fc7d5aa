"""Affine models by exact propagators and harmonics: against continuous truth, SciPy and differences."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.physics.models.heave_pitch import heave_pitch, heave_pitch_zoh
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.published import QI2025_HEADINGS, theoretical_coefficients
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch
from seatrial.physics.simulate.linear import LinearBatch, frequency_response, harmonic_motion, linear_system

FIN = {"lift_1": 7.9e5, "x_f1": -25.0}
STATES = ("z", "z_dot", "theta", "theta_dot")
CORRECTIONS = (InputCorrection("F3", "gain"), InputCorrection("M5", "delay"), InputCorrection("delta_f1", "zero"))


def ship(heading: int = 135, held: bool = False) -> Model:
    model = theoretical_coefficients(heading).applied_to(heave_pitch())
    return (heave_pitch_zoh().with_parameters(model.parameters) if held else model).with_values(FIN)


def waves(time: Array) -> tuple[Array, Array]:
    w, phase = np.array([0.7, 1.1, 1.9, 2.6]), np.array([0.3, 2.0, 4.1, 5.5])
    return 2e5 * np.cos(np.outer(time, w) + phase).sum(1), 5e6 * np.sin(np.outer(time, w) + phase).sum(1)


def inputs(dt: float, count: int, rng: np.random.Generator) -> Array:
    u = np.zeros((count, 4))
    u[:, 0], u[:, 1] = waves(np.arange(count) * dt)
    u[:, 2] = np.repeat(rng.choice([-0.17, 0.17], count // 10 + 1), 10)[:count]
    return u


def test_continuous_waves_and_a_held_fin_equal_the_integrated_equations(rng: np.random.Generator) -> None:
    model, dt = ship(), 0.1
    u = inputs(dt, 301, rng)

    def rate(t: float, x: Array) -> Array:
        out, now = np.empty(4), u[min(int(t / dt + 1e-9), 300)].copy()
        now[:2] = [wave[0] for wave in waves(np.array([t]))]
        model.compiled.rates(t, x, now, model.parameters.values, out)
        return out

    y, _ = LinearBatch(model, u, np.array([0, 301]), dt, STATES).simulate(
        0, 1, np.zeros((1, 4)), model.parameters.values[None], np.empty((1, 0))
    )
    x = np.zeros(4)
    for k in range(300):  # step by step: the fin jumps
        x = solve_ivp(rate, (k * dt, (k + 1) * dt - 1e-12), x, rtol=1e-9, atol=1e-12).y[:, -1]
    scale = np.abs(y).max(axis=0)
    np.testing.assert_allclose(y[-1] / scale, x / scale, atol=1e-4)


def test_segments_of_all_lengths_have_the_inputs_that_each_has_alone(rng: np.random.Generator) -> None:
    u, dt = inputs(0.1, 120, rng), 0.1
    offsets = np.array([0, 30, 60, 120])
    u[30:60] = u[:30]
    together = LinearBatch(ship(), u, offsets, dt, STATES)
    for segment, (first, behind) in enumerate(pairwise(offsets.tolist())):
        alone = LinearBatch(ship(), u[first:behind], np.array([0, behind - first]), dt, STATES)
        np.testing.assert_array_equal(together.fine_inputs(segment)[0], alone.fine_inputs(0)[0])
    assert together.fine_inputs(0)[0] is together.fine_inputs(1)[0]


@pytest.mark.parametrize("heading", QI2025_HEADINGS)
def test_held_waves_equal_the_hold_of_each_sample(heading: int, rng: np.random.Generator) -> None:
    model = ship(heading, held=True)
    u = inputs(0.5, 41, rng)
    exact, _ = LinearBatch(model, u, np.array([0, 41]), 0.5, ("z", "theta")).simulate(
        0, 1, np.zeros((1, 4)), model.parameters.values[None], np.empty((1, 0))
    )
    steps = 200
    fine = np.repeat(u[:-1], steps, axis=0)
    x = np.zeros(4)
    for row in fine:
        k = [np.empty(4) for _ in range(4)]
        h = 0.5 / steps
        for i, c in enumerate([0.0, 0.5, 0.5, 1.0]):
            model.compiled.rates(0.0, x + c * h * k[i - 1] if i else x, row, model.parameters.values, k[i])
        x = x + h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])
    np.testing.assert_allclose(exact[-1], x[[0, 2]], rtol=1e-9)


def test_sensitivities_equal_differences_of_the_computed_numbers(rng: np.random.Generator) -> None:
    model = ship()
    batch = LinearBatch(
        model, inputs(0.5, 81, rng), np.array([0, 41, 81]), 0.5, ("z", "theta"), COEFFICIENTS, CORRECTIONS, STATES
    )
    start, p = 0.1 * rng.normal(size=(2, 4)), np.tile(model.parameters.values, (2, 1))
    c = np.array([[1.05, 0.07, 0.02], [0.97, -0.03, 0.0]])
    y, s, _ = batch.differentiate(0, 2, start, p, c)
    assert np.array_equal(y, batch.simulate(0, 2, start, p, c)[0])

    def moved(point: tuple[Array, Array, Array], which: int, column: int, h: float) -> Array:
        changed = [a.copy() for a in point]
        changed[which][:, column] += h
        return batch.simulate(0, 2, *changed)[0]

    targets = [(1, model.parameters.index(n)) for n in COEFFICIENTS] + [(2, j) for j in range(3)]
    targets += [(0, j) for j in range(4)]
    for column, (which, j) in enumerate(targets):
        point = (start, p, c)
        h = 1e-5 * max(1.0, float(np.abs(point[which][0, j])))
        numeric = (moved(point, which, j, h) - moved(point, which, j, -h)) / (2 * h)
        exact = s[:, :, column]
        np.testing.assert_allclose(exact, numeric, atol=2e-7 * np.abs(exact).max())


def test_without_input_the_motion_dies_out_and_without_a_gap(rng: np.random.Generator) -> None:
    model = ship()
    start = rng.normal(size=(1, 4))
    y, failed = LinearBatch(model, np.zeros((200, 4)), np.array([0, 200]), 0.5, STATES).simulate(
        0, 1, start, model.parameters.values[None], np.empty((1, 0))
    )
    assert failed[0] == -1
    assert np.abs(y[-1]).max() < 1e-6 * np.abs(start).max()


def test_runge_kutta_agrees_where_its_steps_are_fine(rng: np.random.Generator) -> None:
    model, u = ship(), inputs(0.02, 501, rng)
    u[:, 2] = 0.0
    args = (model, u, np.array([0, 501]), 0.02, ("z", "theta"))
    point = (np.zeros((1, 4)), model.parameters.values[None], np.empty((1, 0)))
    exact, rk4 = LinearBatch(*args).simulate(0, 1, *point)[0], SegmentBatch(*args).simulate(0, 1, *point)[0]
    scale = np.abs(exact).max(axis=0)  # inputs straight between samples there: (omega h)^2 / 12 = 2e-4
    np.testing.assert_allclose(exact / scale, rk4 / scale, atol=3e-4)


def test_motion_in_harmonics_equals_the_propagated_one(rng: np.random.Generator) -> None:
    model = theoretical_coefficients(90).applied_to(heave_pitch())
    omega, dt, n = np.array([0.7, -1.3, 2.1]), 0.02, 2001
    amplitude = np.zeros((3, 4), complex)
    amplitude[:, :2] = rng.normal(size=(3, 2, 2)) @ [1, 1j] * [2e5, 5e6]
    time, start = np.arange(n) * dt, rng.normal(size=4) * 0.1
    exact = harmonic_motion(linear_system(model), omega, amplitude, time, start)
    u = (np.exp(1j * np.outer(time, omega)) @ amplitude).real
    y, _ = LinearBatch(model, np.ascontiguousarray(u), np.array([0, n]), dt, model.states).simulate(
        0, 1, start[None], model.parameters.values[None], np.empty((1, 0))
    )
    np.testing.assert_allclose(y, exact, atol=1e-5 * np.abs(exact).max())


def test_a_constant_force_is_met_by_the_stiffness() -> None:
    model = theoretical_coefficients(180).applied_to(heave_pitch())
    still = frequency_response(linear_system(model, ("z", "theta")), np.zeros(1))[0, :, :2].real
    stiffness = np.array([[3.15e6, 6.83e6], [6.83e6, 6.54e8]])
    np.testing.assert_allclose(still @ stiffness, np.eye(2), atol=1e-9)


def test_a_ship_that_turns_has_no_frequency_response() -> None:
    with pytest.raises(InputError, match="not linear"):
        linear_system(nomoto())
