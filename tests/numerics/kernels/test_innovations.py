"""The filter against matrices: likelihood, sensitivities and variances of a linear model, written with numpy here."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from seatrial.core.equations import Model
from seatrial.physics.simulate.batch import InputCorrection
from seatrial.physics.simulate.filtering import FilterPoint, KalmanFilter

Array = NDArray[np.float64]
K, C, B = 1.5, 0.3, 0.8
OUTPUTS = ("x0", "v_dot")
DT, ROWS = 0.01, 400
INTENSITY, DEVIATION = np.array([0.05, 0.4]), np.array([0.02, 0.3])
START, VARIANCE = np.array([0.3, -0.2]), np.array([0.04, 0.09])


@dataclass(frozen=True)
class Matrices:
    """x' = A x + (0, B u) with x0 and v' measured, u held constant over the whole run."""

    k: float = K
    c: float = C
    u: float = 0.7

    def filtered(self, measured: Array, intensity: Array, deviation: Array) -> tuple[Array, Array]:
        """Innovations and variances, one scalar after the other, in the order of the outputs."""
        A = np.array([[0.0, 1.0], [-self.k, -self.c]])
        phi, rest = expm(DT * A), np.linalg.solve(A, np.array([0.0, B * self.u]))
        H, feed = np.array([[1.0, 0.0], [-self.k, -self.c]]), np.array([0.0, B * self.u])
        x, P, half = START.copy(), np.diag(VARIANCE), 0.5 * DT * np.diag(intensity**2)
        e, v = np.zeros_like(measured), np.ones_like(measured)
        for row in range(len(measured)):
            for i in np.flatnonzero(np.isfinite(measured[row])):
                e[row, i] = measured[row, i] - H[i] @ x - feed[i]
                v[row, i] = H[i] @ P @ H[i] + deviation[i] ** 2
                gain = P @ H[i] / v[row, i]
                x = x + gain * e[row, i]
                P = (np.eye(2) - np.outer(gain, H[i])) @ P
            x = phi @ (x + rest) - rest
            P = phi @ (P + half) @ phi.T + half
        return e, v


@pytest.fixture(scope="module")
def measured() -> Array:
    made = np.random.default_rng(8).standard_normal((ROWS, 2)) * [0.3, 0.8]
    made[50:60, 0] = np.nan
    made[55:90, 1] = np.nan
    return made


def filter_of(model: Model, outputs: tuple[str, ...] = OUTPUTS) -> KalmanFilter:
    inputs = np.full((ROWS, 1), 0.7)
    corrections = tuple(InputCorrection("delta", kind) for kind in ("zero", "gain", "delay"))
    return KalmanFilter(model, inputs, np.array([0, ROWS]), DT, outputs, ("k", "c"), corrections, driven=("x0", "v"))


def point(model: Model, **changes: float) -> FilterPoint:
    values = model.with_values(changes).parameters.values
    return FilterPoint(START[None], VARIANCE[None], values[None], np.array([[0.0, 1.0, 0.0]]), INTENSITY, DEVIATION)


def test_innovations_are_those_of_matrices(oscillator: Model, measured: Array) -> None:
    e, v, failed = filter_of(oscillator).innovations(0, measured, point(oscillator))
    expected = Matrices().filtered(measured, INTENSITY, DEVIATION)
    assert not failed
    np.testing.assert_allclose(e, expected[0], atol=1e-9)
    np.testing.assert_allclose(v, expected[1], rtol=1e-9)


def test_sensitivities_leave_the_innovations_as_they_are(oscillator: Model, measured: Array) -> None:
    run, at = filter_of(oscillator), point(oscillator)
    bare, full = run.innovations(0, measured, at), run.sensitivities(0, measured, at)
    np.testing.assert_array_equal(bare[0], full[0])
    np.testing.assert_array_equal(bare[1], full[1])


@pytest.mark.parametrize("column", range(4))
def test_noise_sensitivities_are_those_of_matrices(oscillator: Model, measured: Array, column: int) -> None:
    _, _, de, dv, _ = filter_of(oscillator).sensitivities(0, measured, point(oscillator))
    sides = []
    squares = np.concatenate([INTENSITY, DEVIATION]) ** 2
    for step in (1e-5, -1e-5):
        moved = np.sqrt(squares * (1.0 + step * (np.arange(4) == column)))
        sides.append(Matrices().filtered(measured, moved[:2], moved[2:]))
    by = 2e-5 * squares[column]
    size = np.abs(sides[0][0] - sides[1][0]).max() / by, np.abs(sides[0][1] - sides[1][1]).max() / by
    np.testing.assert_allclose(de[:, :, 5 + column], (sides[0][0] - sides[1][0]) / by, atol=1e-6 * size[0])
    np.testing.assert_allclose(dv[:, :, column], (sides[0][1] - sides[1][1]) / by, atol=1e-6 * size[1])


def test_an_input_moves_the_mean_alone(oscillator: Model, measured: Array) -> None:
    """The gain of a linear model does not depend on its input, so these columns are exact."""
    moving = replace(filter_of(oscillator), inputs=np.sin(0.03 * np.arange(ROWS))[:, None])
    at = point(oscillator)
    at = replace(at, corrections=np.array([[0.02, 1.1, 0.053]]))
    de = moving.sensitivities(0, measured, at)[2]
    for c in range(3):
        step = 1e-6 * (np.arange(3) == c)
        e = [moving.innovations(0, measured, replace(at, corrections=at.corrections + s))[0] for s in (step, -step)]
        np.testing.assert_allclose(de[:, :, 2 + c], (e[0] - e[1]) / 2e-6, atol=1e-6)


def test_parameters_move_a_certain_mean(oscillator: Model, measured: Array) -> None:
    """Without process noise and with a known start the gain is zero, and the columns of parameters are exact."""
    run, at = filter_of(oscillator), replace(point(oscillator), start_variance=np.zeros((1, 2)), intensity=np.zeros(2))
    de = run.sensitivities(0, measured, at)[2]
    for c, name in enumerate(("k", "c")):
        value, e = oscillator.parameters[name].value, []
        for step in (1e-6, -1e-6):
            moved = oscillator.with_values({name: value + step}).parameters.values[None]
            e.append(run.innovations(0, measured, replace(at, parameters=moved))[0])
        np.testing.assert_allclose(de[:, :, c], (e[0] - e[1]) / 2e-6, atol=1e-6)


def test_variances_grow_as_those_of_matrices(oscillator: Model) -> None:
    """The Lyapunov equation P' = A P + P A' + Q, integrated by a matrix exponential (Van Loan 1978)."""
    A, Q = np.array([[0.0, 1.0], [-K, -C]]), np.diag(INTENSITY**2)
    block = expm(DT * np.block([[-A, Q], [np.zeros((2, 2)), A.T]]))
    phi = block[2:, 2:].T
    noise, P = phi @ block[:2, 2:], np.diag(VARIANCE)
    made = filter_of(oscillator).variances(0, point(oscillator))
    for row in range(ROWS):
        np.testing.assert_allclose(made[row], np.diag(P), rtol=2e-5)
        P = phi @ P @ phi.T + noise


def test_a_run_that_leaves_all_bounds_is_stated(explosive: Model) -> None:
    run = KalmanFilter(explosive, np.zeros((100, 1)), np.array([0, 100]), 0.1, ("u",))
    at = FilterPoint(
        np.array([[5.0]]),
        np.zeros((1, 1)),
        explosive.parameters.values[None],
        np.zeros((1, 0)),
        np.zeros(0),
        np.ones(1),
    )
    assert run.innovations(0, np.full((100, 1), np.nan), at)[2]
