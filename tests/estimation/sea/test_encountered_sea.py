"""Densities of encounter against the transformation of spectra, and against the transforms of simulated motions."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.estimation.sea import encountered_sea, sea_spectrum, stretch_spectra
from seatrial.physics.loops import WAVE_SLOPE, HullFactor
from seatrial.physics.sea import wave_frequency

SEA = np.log([2.5, 8.0, 1.3])
BINS = np.arange(8, 40) * 0.03
HULL = HullFactor(100.0, 10.5, 3.4)


def test_spectrum_has_the_height_and_period_of_its_unknowns() -> None:
    spectrum = sea_spectrum(SEA)
    assert spectrum.significant_height == pytest.approx(2.5)
    assert 2.0 * math.pi / spectrum.modal_frequency == pytest.approx(8.0)


@pytest.mark.parametrize("beta", [math.pi / 2, 2.4, math.pi])
def test_density_in_beam_and_head_seas_is_the_transformed_spectrum(beta: float) -> None:
    """S(omega_e) = S(omega) / |d omega_e / d omega| (Lloyd 1989, section 7.4), smeared little by a long window."""
    U, fine = 8.0, np.arange(160, 800) * 0.0015
    sea = encountered_sea(fine, U, beta, WAVE_SLOPE)
    omega = wave_frequency(fine, U, beta)
    slope = 1.0 - 2.0 * omega * U * math.cos(beta) / 9.80665
    expected = sea_spectrum(SEA).density(omega) / np.abs(slope)
    sin = np.abs(WAVE_SLOPE.amplitude(omega, U, beta)) ** 2
    inner = slice(40, -40)
    got = sea.density(SEA, np.ones(len(sea.omega)))
    assert np.max(np.abs(got - expected * sin)[inner]) < 0.01 * np.max(expected * sin) + 1e-12


def test_following_seas_keep_the_energy_of_all_three_waves() -> None:
    U, beta = 12.0, math.radians(30.0)
    sea = encountered_sea(np.arange(1, 200) * 0.01, U, beta, HULL)
    density = sea.density(SEA, np.ones(len(sea.omega)))
    inside = (sea.omega_e > 0.05) & (sea.omega_e < 1.8)
    energy = float(np.sum(sea.disturbance_energy(SEA)[inside]))
    bins = np.arange(1, 200) * 0.01
    kept = (bins > 0.05) & (bins < 1.8)
    assert float(np.sum(density[kept])) * 0.01 == pytest.approx(energy, rel=0.03)


def test_welch_density_of_white_noise_is_flat_at_its_level() -> None:
    dt, noise = 0.5, np.random.default_rng(3).standard_normal((40_000, 1))
    spectra = stretch_spectra(noise, dt, 100.0)
    level = spectra.cross_density(0, 0).real
    assert np.mean(level) == pytest.approx(dt / math.pi, rel=0.01)
    assert np.std(level) / np.mean(level) == pytest.approx(1.0 / math.sqrt(len(spectra.transforms) / 1.056), rel=0.2)


def test_strong_band_is_about_the_peak() -> None:
    t = np.arange(0.0, 2000.0, 0.5)
    values = np.sin(0.8 * t) + 0.01 * np.random.default_rng(1).standard_normal(len(t))
    band = stretch_spectra(values[:, None], 0.5, 150.0).strong_band(0, 0.03)
    assert band.omega[0] < 0.8 < band.omega[-1]
    assert len(band.omega) <= 5


@pytest.mark.parametrize(("values", "words"), [(np.zeros((100, 1)), "too short"), (np.full((4000, 1), np.nan), "gaps")])
def test_stretches_that_have_no_spectrum_are_refused(values: np.ndarray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        stretch_spectra(values, 0.5, 100.0)
