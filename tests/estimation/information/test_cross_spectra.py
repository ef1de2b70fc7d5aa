"""Cross-spectra against scipy.signal, and the circle about a response against a filter of known response."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import signal

from seatrial.estimation.information.frequency_response import CrossSpectra, cross_spectra, power_density

Array = NDArray[np.float64]
DT, LENGTH, POLE = 0.1, 256, 0.7


def filtered(seed: int, noise: float, rows: int = 4096) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    u = rng.standard_normal(rows)
    return u, signal.lfilter([1.0], [1.0, -POLE], u) + noise * rng.standard_normal(rows)


def spectra(u: Array, y: Array) -> CrossSpectra:
    result = cross_spectra([(u, y[:, None])], LENGTH, DT)
    assert result is not None
    return result


@pytest.mark.parametrize("rows", [4096, 4000])
def test_densities_are_those_of_scipy(rows: int) -> None:
    u, y = filtered(1, 0.5, rows)
    u, y = u + 0.01 * np.arange(rows), y - 0.02 * np.arange(rows)
    ours, inner = spectra(u, y), slice(2, -1)

    def of_scipy(a: Array, b: Array) -> tuple[Array, Array]:
        hertz, density = signal.csd(a, b, 1.0 / DT, nperseg=LENGTH, detrend="linear")
        return 2.0 * np.pi * hertz[inner], density[inner] / (2.0 * np.pi)

    np.testing.assert_allclose(ours.omega, of_scipy(u, u)[0])
    np.testing.assert_allclose(ours.input, of_scipy(u, u)[1].real, rtol=1e-12)
    np.testing.assert_allclose(ours.outputs[:, 0], of_scipy(y, y)[1].real, rtol=1e-12)
    np.testing.assert_allclose(ours.cross[:, 0], of_scipy(u, y)[1], rtol=1e-9)
    coherence = signal.coherence(u, y, 1.0 / DT, nperseg=LENGTH, detrend="linear")[1][inner]
    np.testing.assert_allclose(ours.coherence[:, 0], coherence, rtol=1e-9)


def test_runs_are_averaged_and_gaps_left_out() -> None:
    u, y = filtered(2, 0.5)
    halves = cross_spectra([(u[:2048], y[:2048, None]), (u[2048:], y[2048:, None])], LENGTH, DT)
    assert halves is not None
    parts = [spectra(u[:2048], y[:2048]), spectra(u[2048:], y[2048:])]
    np.testing.assert_allclose(halves.cross, np.mean([p.cross for p in parts], axis=0))
    np.testing.assert_allclose(halves.averages, 2.0 * parts[0].averages)
    gap = y.copy()
    gap[LENGTH // 4] = np.nan
    np.testing.assert_allclose(spectra(u, gap).cross, spectra(u[LENGTH // 2 :], y[LENGTH // 2 :]).cross)
    assert cross_spectra([(u, np.full((len(u), 1), np.nan))], LENGTH, DT) is None


@pytest.mark.parametrize("bands", [None, 25])
def test_the_circle_holds_the_true_response_in_95_of_100_cases(bands: int | None) -> None:
    """200 records of 15 to 120 frequencies: the share scatters by less than 0.01."""
    inside = []
    for seed in range(200):
        one = spectra(*filtered(seed, 1.0))
        one = one if bands is None else one.banded(bands)
        truth = 1.0 / (1.0 - POLE * np.exp(-1j * one.omega * DT))
        inside.append(np.mean(np.abs(one.response[:, 0] - truth) <= one.radius[:, 0]))
    assert np.mean(inside) == pytest.approx(0.95, abs=0.015)


def test_bands_keep_power_and_every_frequency() -> None:
    one = spectra(*filtered(3, 0.5))
    banded = one.banded(10)
    assert len(banded.omega) <= 10
    assert np.all(np.diff(banded.omega) > 0.0)
    assert banded.averages[-1] > 5.0 * one.averages[-1]
    first = one.omega <= one.omega[0] * (one.omega[-1] / one.omega[0]) ** 0.1
    np.testing.assert_allclose(banded.input[0], np.mean(one.input[first]))


@pytest.mark.parametrize("length", [256, 101])
def test_the_density_of_one_channel_is_that_of_scipy_at_every_frequency(length: int) -> None:
    _, y = filtered(2, 0.5, 1000)
    omega, density = power_density(y[:, None], length, DT)
    hertz, expected = signal.welch(y, 1.0 / DT, nperseg=length, detrend="linear")
    np.testing.assert_allclose(omega, 2.0 * np.pi * hertz)
    np.testing.assert_allclose(density[:, 0], expected / (2.0 * np.pi), rtol=1e-12, atol=1e-12 * expected.max())
