"""Waves in the filter: innovations, variances and slopes against a dense Kalman filter written apart."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_lyapunov

from seatrial.core.values import Record
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.sensors.wave_motion import WaveMotion

Array = NDArray[np.float64]
NONE = np.zeros((0, 0))
K, T, DT, ROWS = 0.12, 9.0, 1.0, 80
OUTPUTS = ("r", "psi")
INTENSITY, DEVIATION = 2e-4, np.array([1e-3, 4e-3])
SHAPE = np.array([1.3, 0.1, 0.5, 0.05])  # rad/s and relative damping of sea and swell
SIZES = np.array([8e-5, 3e-5])  # rad^2, of the heading at each peak
START_VARIANCE = np.array([1e-4, 1e-3])


@pytest.fixture(scope="module")
def record() -> Record:
    rng = np.random.default_rng(3)
    time = DT * np.arange(ROWS)
    delta = 0.2 * np.sin(0.1 * time)
    values = {"r": 0.02 * rng.standard_normal(ROWS), "psi": 0.1 * rng.standard_normal(ROWS)}
    return Record.from_arrays("run", time, {"delta": delta, **values})


@pytest.fixture(scope="module")
def problem(record: Record) -> PredictionError:
    data = cut_segments(nomoto(), [record], OUTPUTS, None)
    data = replace(data, measured=np.where(np.arange(2 * ROWS).reshape(ROWS, 2) % 7 == 3, np.nan, data.measured))
    runs = OutputError(nomoto(), data, DEVIATION, substeps=4, workers=1)
    start, variance = np.zeros((1, 4)), np.array([[*START_VARIANCE, 0.0, 0.0]])
    waves = WaveMotion(("psi",), 2)
    return PredictionError(runs, ("r",), start, variance, np.full(2, np.nan), waves=waves)


def point_of(k: float, t: float) -> Array:
    return np.concatenate([[k, t, INTENSITY**2], SHAPE, SIZES, DEVIATION**2])


def dense_innovations(problem: PredictionError) -> tuple[Array, Array]:
    """Innovations and variances by matrices of six states; process noise half before and half after, as documented."""
    a = np.zeros((6, 6))
    a[0, 0], a[1, 0] = -1.0 / T, 1.0
    noise = np.zeros((6, 6))
    p = np.diag([*START_VARIANCE, 0.0, 0.0, 0.0, 0.0])
    for k, (omega, zeta) in enumerate(SHAPE.reshape(2, 2)):
        rows = slice(2 + 2 * k, 4 + 2 * k)
        a[rows, rows] = [[0.0, 1.0], [-(omega**2), -2.0 * zeta * omega]]
        q = 4.0 * zeta * omega**3 * SIZES[k]
        stationary = solve_continuous_lyapunov(a[rows, rows], -np.diag([0.0, q]))
        p[rows, rows] = stationary
        phi = expm(a[rows, rows] * DT)
        noise[rows, rows] = stationary - phi @ stationary @ phi.T
    phi, half = expm(a * DT), np.zeros((6, 6))
    half[0, 0] = 0.5 * INTENSITY**2 * DT
    h = np.array([[1.0, 0, 0, 1, 0, 1], [0, 1, 1, 0, 1, 0]])
    x, data = np.zeros(6), problem.runs.data
    e, v = np.zeros((ROWS, 2)), np.ones((ROWS, 2))
    for row in range(ROWS):
        for c in range(2):
            if np.isnan(data.measured[row, c]):
                continue
            v[row, c] = h[c] @ p @ h[c] + DEVIATION[c] ** 2
            e[row, c] = data.measured[row, c] - h[c] @ x
            gain = p @ h[c] / v[row, c]
            x, p = x + gain * e[row, c], p - np.outer(gain, h[c] @ p)
        if row < ROWS - 1:
            u0, u1 = data.inputs[row, 0], data.inputs[row + 1, 0]
            x = phi @ x + _driven(a, u0, u1)
            p = phi @ (p + half) @ phi.T + half + noise
    return e, v


def _driven(a: Array, u0: float, u1: float) -> Array:
    """The craft's answer to an input that runs straight: the input and its slope are two more states."""
    b = np.zeros((8, 8))
    b[:6, :6], b[0, 6], b[6, 7] = a, K / T, 1.0
    return (expm(b * DT) @ np.array([0.0, 0, 0, 0, 0, 0, u0, (u1 - u0) / DT]))[:6]


def test_innovations_are_those_of_a_dense_filter(problem: PredictionError) -> None:
    found = problem.innovations(point_of(K, T))
    e, v = dense_innovations(problem)
    measured = np.isfinite(problem.runs.data.measured)
    np.testing.assert_allclose(found.e[measured], e[measured], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.variance[measured], v[measured], rtol=1e-7)


def test_the_gradient_is_the_slope_of_the_cost(problem: PredictionError) -> None:
    point = point_of(K, T)
    normal = problem.normal(point, NONE)
    noise = slice(2, None)  # those of the craft count the gain as constant
    steps = 1e-4 * point
    slope = [
        (problem.cost(point + s, NONE) - problem.cost(point - s, NONE)) / (2.0 * np.max(s)) for s in np.diag(steps)
    ]
    np.testing.assert_allclose((normal.gradient * point)[noise], (slope * point)[noise], rtol=1e-4, atol=1e-5)


def test_forecasts_hold_the_waves(problem: PredictionError) -> None:
    """Two samples ahead of the last one measured: the dense filter with the last two samples left out."""
    point = point_of(K, T)
    ahead = problem.predicted_ahead(point, 0, np.array([ROWS - 3]), 2)[0]
    measured = problem.runs.data.measured.copy()
    measured[-2], measured[-1] = np.nan, [np.nan, 0.1]
    without = replace(problem, runs=replace(problem.runs, data=replace(problem.runs.data, measured=measured)))
    e = dense_innovations(without)[0]
    assert 0.1 - ahead[2, 1] == pytest.approx(e[-1, 1], rel=1e-4)


def test_waves_of_a_peak_add_their_variances() -> None:
    waves = WaveMotion(("psi", "u"), 2)
    unknowns = np.array([1.0, 0.1, 0.5, 0.1, 4.0, 1.0, 9.0, 2.0])
    np.testing.assert_allclose(
        waves.variances(unknowns, ("psi", "r", "u", "x0")), [[4.0, 4.0, 1.0, 0.0], [9.0, 9.0 * 0.25, 2.0, 0.0]]
    )
