"""Propagators and their derivatives against SciPy's matrix exponential of the block matrix (Van Loan 1978)."""

import numpy as np
import pytest
from scipy.linalg import expm, expm_frechet

from seatrial.numerics.kernels.propagate import propagators


@pytest.mark.parametrize("size", [0.01, 1.0, 30.0])
def test_values_and_derivatives_equal_the_block_exponential(size: float, rng: np.random.Generator) -> None:
    n, count, h = 4, 3, 0.5
    a, da = size * rng.normal(size=(n, n)), rng.normal(size=(count, n, n))
    value, slope = propagators(a, da, h)
    block, zero = np.zeros((3 * n, 3 * n)), np.zeros((3 * n, 3 * n))
    block[:n, :n], block[:n, n : 2 * n], block[n : 2 * n, 2 * n :] = a, np.eye(n), np.eye(n)
    whole = expm(block * h)
    for m, (expected, unit) in enumerate([(whole[:n, :n], 1.0), (whole[:n, n : 2 * n], 1.0), (whole[:n, 2 * n :], h)]):
        np.testing.assert_allclose(value[m], expected / unit, atol=1e-12 * np.abs(expected).max() / unit)
    for q in range(count):
        zero[:n, :n] = da[q]
        derivative = expm_frechet(block * h, zero * h)[1][:n]
        for m, unit in enumerate([1.0, 1.0, h]):
            expected = derivative[:, m * n : (m + 1) * n] / unit
            np.testing.assert_allclose(slope[q, m], expected, atol=2e-12 * np.abs(expected).max())


def test_a_matrix_beyond_all_scaling_gives_nan() -> None:
    value, _ = propagators(np.full((2, 2), 1e30), np.zeros((0, 2, 2)), 1.0)
    assert np.isnan(value).all()
