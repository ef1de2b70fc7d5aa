"""From records to responses: harmonics, and the waves that go on and come back."""

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import group_velocity, wavenumber
from seatrial_studies.section2d.responses import (
    Probes,
    best_fit_frequency,
    calibrate_wave_probes,
    harmonics,
    separate_waves,
    whole_periods,
)

# Amplitudes in regular waves: exact without noise, at the Cramer-Rao bound with it, refused where void.

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


# Waves onward and back: a made-up flume is taken apart again, and its probes are found.

PLACES, GAINS, DEPTH, DT = np.array([0.0, 1.95, 2.2, 2.5]), np.array([1.0, 0.95, 1.03, 0.98]), 1.0, 0.02
OMEGAS = (4.95, 5.43, 5.86, 7.0)
BACK = 0.6 * np.exp(1.1j)


def elevations(omega: float, size: int = 3000) -> np.ndarray:
    """A ramped wave onward and its reflection back, read by probes with gains: (n, p)."""
    time = DT * np.arange(size)
    envelope = np.clip((time - 15.0) / 6.0, 0.0, 1.0) * np.clip((48.0 - time) / 6.0, 0.0, 1.0)
    spectrum = np.fft.fft(0.012 * envelope * np.exp(1j * omega * time), 4096)
    frequencies = 2.0 * np.pi * np.fft.fftfreq(4096, DT)
    kept = (frequencies > 0.5 * omega) & (frequencies < 1.6 * omega)
    k = wavenumber(frequencies[kept], DEPTH)
    made = []
    for x, g in zip(PLACES, GAINS, strict=True):
        part = np.zeros(4096, dtype=complex)
        part[kept] = spectrum[kept] * (np.exp(-1j * k * x) + BACK * np.exp(1j * k * (x - 8.0)))
        made.append(np.fft.ifft(part).real[:size] / g)
    return np.stack(made, axis=1)


def test_both_waves_are_recovered_beyond_the_probes() -> None:
    omega, place = OMEGAS[1], 4.0
    waves = separate_waves(elevations(omega), DT, omega, Probes(PLACES, GAINS, DEPTH), place)
    time, k = DT * np.arange(3000), float(wavenumber(omega, DEPTH))
    rows = slice(1500, 1500 + round(5 * 2.0 * np.pi / omega / DT))
    onward, back = (harmonics(time[rows], w[rows], omega).first for w in (waves.incident, waves.reflected))
    assert onward == pytest.approx(0.012 * np.exp(-1j * k * place), rel=0.02)
    assert back == pytest.approx(0.012 * BACK * np.exp(1j * k * (place - 8.0)), rel=0.03)


def test_the_front_arrives_with_the_group_velocity() -> None:
    omega = OMEGAS[1]
    waves = separate_waves(elevations(omega), DT, omega, Probes(PLACES, GAINS, DEPTH), 4.0)
    envelope = np.abs(waves.incident)
    half = DT * float(np.argmax(envelope > 0.5 * envelope.max()))
    assert half == pytest.approx(18.0 + 4.0 / float(group_velocity(omega, DEPTH)), abs=1.0)


def test_places_and_gains_are_found_from_several_periods() -> None:
    found = calibrate_wave_probes([(elevations(w), DT, w) for w in OMEGAS], DEPTH, (1.9, 2.25, 2.45))
    assert found.positions == pytest.approx(PLACES, abs=0.003) and found.gains == pytest.approx(GAINS, abs=0.01)
    assert found.misfit < 0.02


def test_two_probes_are_not_enough() -> None:
    with pytest.raises(InputError, match="three probes"):
        calibrate_wave_probes([(elevations(5.0), DT, 5.0)], DEPTH, (1.9,))
