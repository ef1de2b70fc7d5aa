"""A filter that nothing corrects is a simulation: the same inputs with the same corrections, derivatives included."""

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch
from seatrial.physics.simulate.filtering import FilterPoint, KalmanFilter, corrected_inputs

Array = NDArray[np.float64]
OUTPUTS = ("u", "v", "r", "psi", "x0", "y0")
DT, ROWS = 0.25, 80
CORRECTIONS = tuple(InputCorrection("delta", kind) for kind in ("zero", "gain", "delay"))
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
