"""A filter that nothing corrects is a simulation: the same inputs with the same corrections, derivatives included."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.physics.models.heave_pitch import heave_pitch_zoh
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.sensors import Compass, Sensors, VelocityReference, with_sensors
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch
from seatrial.physics.simulate.filtering import FilterPoint, KalmanFilter, corrected_inputs
from seatrial.physics.simulate.linear import LinearBatch

Array = NDArray[np.float64]
OUTPUTS = ("u", "v", "r", "psi", "x0", "y0")
DT, ROWS = 0.25, 80
CORRECTIONS = tuple(InputCorrection("delta", kind) for kind in ("zero", "gain", "delay"))
# kg, kg m^2 and SI of a ship of 440 t that heaves and pitches at 1.9 and 1.6 rad/s; chosen
HULL = {"m": 4.4e5, "I5": 1e8, "a33": 4e5, "a55": 1e8, "b33": 1e6, "b55": 2e8, "c33": 3e6, "c55": 5e8}
START = np.array([[0.9, 0.0, 0.0, 0.2, 0.0, 0.0], [1.0, 0.1, 0.0, 0.0, 5.0, 0.0]])


@pytest.fixture
def inputs(rng: np.random.Generator) -> Array:
    return np.stack([rng.uniform(-0.4, 0.4, 2 * ROWS), np.full(2 * ROWS, 1.866)], axis=1)


@pytest.mark.parametrize("substeps", [1, 3])
@pytest.mark.parametrize("delay", [0.0, 0.6, -0.9])
def test_without_gain_it_simulates(inputs: Array, substeps: int, delay: float) -> None:
    model, offsets = waterjet(), np.array([0, ROWS, 2 * ROWS])
    values = np.tile(model.parameters.values, (2, 1))
    own = np.array([[0.02, 1.1, delay], [-0.01, 0.9, delay]])
    names = ("Y_v", "N_r")
    plain = SegmentBatch(model, inputs, offsets, DT, OUTPUTS, names, CORRECTIONS, substeps=substeps)
    y, s, _ = plain.differentiate(0, 2, START, values, own)
    run = KalmanFilter(model, inputs, offsets, DT, OUTPUTS, names, CORRECTIONS, substeps=substeps)
    at = FilterPoint(START, np.zeros((2, 6)), values, own, np.zeros(0), np.ones(6))
    for segment in range(2):
        rows = slice(segment * ROWS, (segment + 1) * ROWS)
        e, v, de, _, failed = run.sensitivities(segment, np.zeros((2 * ROWS, 6)), at)
        assert not failed
        np.testing.assert_allclose(e, -y[rows], rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(v, np.ones((ROWS, 6)))
        np.testing.assert_allclose(de[:, :, :5], -s[rows], rtol=1e-9, atol=1e-11)


def test_of_a_linear_model_inputs_that_are_held_stay_constant_between_samples(rng: np.random.Generator) -> None:
    """Samples half a second apart, as of a ship in waves: the exact propagation of the linear engine."""
    zero = dict.fromkeys((n for n in heave_pitch_zoh().parameters.names if n[0] in "abc"), 0.0)
    model, offsets = heave_pitch_zoh().with_values(zero | HULL), np.array([0, ROWS])
    force = np.zeros((ROWS, 4))
    force[:, :2] = rng.standard_normal((ROWS, 2)) * [1e6, 1e7]
    values, none = model.parameters.values[None], np.zeros((1, 0))
    y, _ = LinearBatch(model, force, offsets, 0.5, ("z", "theta")).simulate(0, 1, np.zeros((1, 4)), values, none)
    run = KalmanFilter(model, force, offsets, 0.5, ("z", "theta"))
    at = FilterPoint(np.zeros((1, 4)), np.zeros((1, 4)), values, none, np.zeros(0), np.ones(2))
    e, _, failed = run.innovations(0, np.zeros((ROWS, 2)), at)
    assert not failed
    np.testing.assert_allclose(e, -y, atol=1e-4 * np.abs(y).max())
    ahead = run.predict_ahead(0, y, replace(at, deviation=np.full(2, 1e3)), np.array([10, 40]), 20)
    np.testing.assert_allclose(ahead[1], y[40:61], atol=1e-3 * np.abs(y).max())


def test_corrections_have_their_derivatives(inputs: Array) -> None:
    gain, zero, delay = np.array([1.1, 0.9]), np.array([0.02, -0.1]), np.array([0.33, -0.4])
    _, weights = corrected_inputs(inputs, DT, gain, zero, delay)
    for j in range(2):
        one = 1e-7 * (np.arange(2) == j)
        sides = [
            [corrected_inputs(inputs, DT, gain + k * g, zero + k * z, delay + k * d)[0]
             for z, g, d in ((one, 0.0, 0.0), (0.0, one, 0.0), (0.0, 0.0, one))]
            for k in (1, -1)
        ]  # fmt: skip
        for kind in range(3):
            expected = (sides[0][kind] - sides[1][kind])[:, j] / 2e-7
            np.testing.assert_allclose(weights[:, 3 * j + kind], expected, atol=1e-6)


def _turned_by_the_heading() -> KalmanFilter:
    """Return a filter of a craft whose velocities over ground were turned by a compass with a zero of its own."""
    model = with_sensors(waterjet(), Sensors(compass=Compass.OFFSET, velocity=VelocityReference.GROUND))
    observed = tuple(model.observable_of(c) for c in ("u", "v", "r", "psi"))
    inputs = np.stack([0.3 * np.sin(np.arange(ROWS) / 5.0), np.full(ROWS, 1.866)], axis=1)
    return KalmanFilter(
        model, inputs, np.array([0, ROWS]), DT, observed, ("N_r", "compass_A"), driven=("v", "r"),
    )  # fmt: skip


def _point(run: KalmanFilter, **changed: float) -> FilterPoint:
    model = run.model.with_values({"compass_A": 0.02} | changed)
    start, variance = np.array([[0.9, 0.1, 0.05, 0.4, 0.0, 0.0]]), np.array([[0.2, 0.1, 0.05, 0.01, 1.0, 1.0]]) ** 2
    return FilterPoint(
        start, variance, model.parameters.values[None], np.zeros((1, 0)), np.array([0.02, 0.01]),
        np.array([0.04, 0.05, 0.01, 0.005]),
    )  # fmt: skip


def test_a_heading_s_error_counts_once_where_velocities_were_turned_by_it() -> None:
    """The first sample's likelihood: that of a normal distribution whose noise is correlated as the turn makes it."""
    run = _turned_by_the_heading()
    at = _point(run)
    reading = np.array([0.95, 0.15, 0.04, 0.39])
    e, v, _ = run.innovations(0, np.vstack([reading, np.full((ROWS - 1, 4), np.nan)]), at)
    loss = 0.5 * np.sum(e[0] ** 2 / v[0] + np.log(v[0]))

    y, s, _ = SegmentBatch(
        run.model, run.inputs, run.offsets, DT, run.outputs, initial_states=run.model.states
    ).differentiate(0, 1, at.start, at.parameters, at.corrections)
    sensors = np.diag(at.deviation**2)
    back = np.eye(4)  # readings behind the turn by those before it: u gains v e, v loses u e
    back[0, 3], back[1, 3] = reading[1], -reading[0]
    covariance = s[0] @ np.diag(at.start_variance[0]) @ s[0].T + back @ sensors @ back.T
    misfit = reading - y[0]
    expected = 0.5 * (misfit @ np.linalg.solve(covariance, misfit) + np.linalg.slogdet(covariance)[1])
    assert loss == pytest.approx(expected, rel=1e-9)


def test_slopes_of_a_sample_that_a_heading_turned(rng: np.random.Generator) -> None:
    """By a coefficient of a craft without process noise, whose gain no coefficient moves at the first samples."""
    run = replace(_turned_by_the_heading(), driven=())
    at = replace(_point(run), start_variance=np.zeros((1, 6)), intensity=np.zeros(0))
    measured = run.simulate(0, 1, at.start, at.parameters, at.corrections)[0] + 0.01 * rng.standard_normal((ROWS, 4))
    _, _, de, _, _ = run.sensitivities(0, measured, at)
    for column, name in enumerate(run.parameters):
        value, step = run.model.with_values({"compass_A": 0.02}).parameters[name].value, 1e-5
        sides = [
            run.innovations(0, measured, replace(at, parameters=_point(run, **{name: value + k * step}).parameters))[0]
            for k in (1, -1)
        ]
        np.testing.assert_allclose(de[..., column], (sides[0] - sides[1]) / (2 * step), rtol=1e-5, atol=1e-6)
