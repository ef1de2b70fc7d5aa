"""Amplitudes in regular waves: exact without noise, at the Cramer-Rao bound with it, refused where void."""

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial_studies.section2d.harmonics import best_fit_frequency, harmonics, whole_periods

OMEGA, DT = 5.2, 0.02
TIME = 30.0 + DT * np.arange(round(6 * 2.0 * np.pi / OMEGA / DT))
TRUTH = 0.012 * np.exp(0.7j)


def signal(extra: complex = 0.001j) -> np.ndarray:
    wave = TRUTH * np.exp(1j * OMEGA * TIME) + extra * np.exp(2j * OMEGA * TIME)
    return wave.real + 0.003 + 0.0002 * (TIME - TIME[0])


def test_without_noise_the_amplitudes_are_exact() -> None:
    made = harmonics(TIME, signal(), OMEGA)
    assert made.first == pytest.approx(TRUTH, rel=1e-10)
    assert made.amplitudes[1] == pytest.approx(0.001j, abs=1e-12) and made.noise < 1e-12


def test_with_white_noise_the_scatter_is_the_bound_and_the_covariance_says_so(rng: np.random.Generator) -> None:
    sigma, repeats = 0.002, 1500
    found = [harmonics(TIME, signal() + sigma * rng.standard_normal(len(TIME)), OMEGA) for _ in range(repeats)]
    bound = sigma * np.sqrt(2.0 / len(TIME))
    errors = np.array([f.first - TRUTH for f in found])
    for part, k in ((errors.real, 0), (errors.imag, 3)):
        assert np.std(part) == pytest.approx(bound, rel=0.08)
        stated = np.sqrt(np.mean([f.covariance[k, k] for f in found]))
        assert stated == pytest.approx(np.std(part), rel=0.08)
        assert abs(np.mean(part)) < 4.0 * bound / np.sqrt(repeats)
    assert np.mean([f.relative_error for f in found]) == pytest.approx(bound / abs(TRUTH), rel=0.08)


def test_whole_periods_are_whole() -> None:
    rows = whole_periods(TIME, TIME[0], TIME[0] + 3.9 * 2.0 * np.pi / OMEGA, OMEGA)
    assert len(TIME[rows]) * DT == pytest.approx(3.0 * 2.0 * np.pi / OMEGA, abs=DT)


def test_the_frequency_is_found_beside_the_nominal_one() -> None:
    values = np.cos(OMEGA * TIME + 0.3)
    assert best_fit_frequency(TIME, values, 1.01 * OMEGA) == pytest.approx(OMEGA, rel=1e-6)


def test_what_has_no_harmonics_is_refused() -> None:
    with pytest.raises(InputError, match="less than one wave period"):
        harmonics(TIME[:30], TIME[:30], OMEGA)
    with pytest.raises(InputError, match="Nyquist"):
        harmonics(TIME, signal(), OMEGA, (1, 40))
    with pytest.raises(InputError, match="order 1"):
        harmonics(TIME, signal(), OMEGA, (2, 3))
    with pytest.raises(InputError, match="NaN"):
        harmonics(TIME, np.where(TIME > 31, np.nan, 0.0), OMEGA)
    with pytest.raises(InputError, match="no whole wave period"):
        whole_periods(TIME, 30.0, 30.5, OMEGA)
