"""Moments of a loop in a sea against those of tuning, of a log against the series; chance by segments left out."""

import math

import numpy as np
import pytest

from seatrial.control.verification.stabiliser import (
    jackknife_deviation,
    logged_moments,
    mean_moments,
    plain_reduction,
    predicted_moments,
    products,
    reduction_by_waves,
)
from seatrial.estimation.sea import encountered_sea, sea_spectrum, stretch_spectra
from seatrial.physics.loops import HullFactor, LoopSignal, Performance, sea_disturbance, variance
from seatrial.physics.loops.structures import fin_loop

LOOP, U, BETA, HULL = fin_loop(), 9.26, math.pi / 2, HullFactor(100.0, 10.5, 3.4)
SEA = np.log([2.0, 8.0, 1.0])


def test_predicted_moments_are_those_of_the_tuning() -> None:
    """The same variances by the quadrature that tuning uses, written independently of the nodes here."""
    orders = ((LoopSignal.OUTPUT, 0), *((LoopSignal.ACTUATOR, order) for order in range(3)))
    rows = tuple(variance("v", "1", signal, order) for signal, order in orders)
    weights = tuple(row for objective in rows for row in objective.variances)
    exposure = sea_disturbance(sea_spectrum(SEA), U, BETA, LOOP.disturbance, HULL)
    tuned = Performance(LOOP, exposure, weights)
    expected = tuned.evaluate(LOOP.gain_values).variances[0]
    sea = encountered_sea(np.arange(4, 200) * 0.02, U, BETA, HULL)
    got = predicted_moments(LOOP, sea, SEA)
    np.testing.assert_allclose([got.output, got.actuator, got.rate, got.acceleration], expected, rtol=0.02)
    assert got.free == pytest.approx(tuned.uncontrolled_variances[0], rel=0.01)
    assert got.reduction == pytest.approx(1.0 - math.sqrt(expected[0] / tuned.uncontrolled_variances[0]), abs=0.005)


def test_logged_moments_are_those_of_the_series() -> None:
    t = np.arange(0.0, 9000.0, 0.25)
    actuator = 0.2 * np.sin(0.9 * t + 0.3)
    P = LOOP.plant.frequency_response(np.array([0.9]))[0]
    free = 0.05 * np.sin(0.9 * t)
    output = free + 0.2 * np.abs(P) * np.sin(0.9 * t + 0.3 + np.angle(P))
    spectra = stretch_spectra(np.stack([output, actuator], axis=1), 0.25, 1500.0)
    plant = LOOP.plant.frequency_response(spectra.omega)
    got = logged_moments(products(spectra).mean(axis=0), spectra.omega, plant)
    assert got.free == pytest.approx(np.var(free), rel=0.02)
    assert got.output == pytest.approx(np.var(output), rel=0.01)
    assert got.rate == pytest.approx(0.9**2 * np.var(actuator), rel=0.01)
    assert got.reversals == pytest.approx(3600.0 / (math.pi / 0.9), rel=0.01)
    assert mean_moments([got, got]) == got


def test_the_ratio_of_wave_spectra_takes_off_what_the_sea_changed() -> None:
    rng = np.random.default_rng(5)
    waves = rng.standard_normal(40_000)

    def mean_products(height: float, share: float) -> np.ndarray:
        zeta = height * waves
        columns = np.stack([0.1 * share * zeta, zeta, zeta], axis=1)
        return products(stretch_spectra(columns, 0.5, 100.0)).mean(axis=0)

    on, off = mean_products(1.5, 0.3), mean_products(1.0, 1.0)
    assert reduction_by_waves(on, off) == pytest.approx(0.7)
    assert plain_reduction(on, off) == pytest.approx(1.0 - 0.45)


def test_leaving_segments_out_gives_the_scatter_of_an_rms() -> None:
    """Of white noise: the standard deviation of the rms over many series."""
    rng, values, deviations = np.random.default_rng(8), [], []

    def rms(means: list[np.ndarray]) -> float:
        return math.sqrt(float(np.sum(np.real(means[0][:, 0, 0]))))

    for _ in range(60):
        leg = products(stretch_spectra(rng.standard_normal((1000, 1)), 0.5, 20.0))
        values.append(rms([leg.mean(axis=0)]))
        deviations.append(jackknife_deviation([leg], rms))
    assert np.mean(deviations) == pytest.approx(np.std(values), rel=0.25)
