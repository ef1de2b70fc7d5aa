"""The same bits as SciPy's Savitzky-Golay filter, ends included."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from seatrial.numerics.local_polynomials import smoothed_locally, white_variance


@pytest.mark.parametrize(("samples", "width", "degree"), [(40, 15, 3), (15, 15, 3), (5, 5, 3), (3, 3, 2), (200, 31, 3)])
@pytest.mark.parametrize("derivative", [0, 1, 2])
@pytest.mark.parametrize("columns", [(), (1,), (4,)])
def test_the_bits_are_those_of_scipy(
    samples: int, width: int, degree: int, derivative: int, columns: tuple[int, ...]
) -> None:
    values = np.random.default_rng(samples).normal(size=(samples, *columns)).cumsum(axis=0)
    expected = savgol_filter(values, width, degree, deriv=derivative, delta=0.1, axis=0)
    assert np.array_equal(smoothed_locally(values, width, degree, derivative, 0.1), expected)


def test_a_cubic_is_left_as_it_is_and_its_slope_exact() -> None:
    t = np.linspace(0.0, 2.0, 21)
    assert np.allclose(smoothed_locally(t**3 - t, 7, 3), t**3 - t, atol=1e-12)
    assert np.allclose(smoothed_locally(t**3 - t, 7, 3, 1, 0.1), 3.0 * t**2 - 1.0, atol=1e-10)


def test_white_noise_is_told_from_what_changes_slowly() -> None:
    noise = np.random.default_rng(1).normal(0.0, 0.3, 20_000)
    slow = 50.0 * np.sin(np.arange(20_000) / 400.0)
    assert white_variance(slow + noise) == pytest.approx(0.09, rel=0.05)
    assert white_variance(noise + 1j * noise[::-1]) == pytest.approx(0.18, rel=0.05)
    assert white_variance(noise[:3]) == 0.0
