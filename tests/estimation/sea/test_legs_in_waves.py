"""Ship and seas from legs: gradients by differences, exact expectation, simulated legs with and without control."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.estimation.sea import (
    PLANT_FACTORS,
    LegPriors,
    LegsInWaves,
    ObservedLeg,
    WaveLeg,
    altered_loop,
    encountered_sea,
    fit_legs,
    stretch_spectra,
)
from seatrial.physics.loops import HullFactor
from seatrial.physics.loops.structures import fin_loop

HULL, U, BETA = HullFactor(100.0, 10.5, 3.4), 9.26, math.pi / 2
PRIORS = LegPriors(np.array([0.2, 0.1, 0.3]), np.array([0.1, 0.05]))
DT, SEGMENT = 0.5, 90.0


def _leg(seed: int, sea: Array, ship: Array, *, is_controlled: bool, duration: float = 1800.0) -> WaveLeg:
    """A leg whose motion is drawn line by line from its own density: Gaussian, exactly of the sea and ship given."""
    loop, rng = altered_loop(fin_loop(), ship), np.random.default_rng(seed)
    count = round(duration / DT)
    # twice the length, so that the stretch is no period of the lines
    omega = 2.0 * np.pi * np.fft.rfftfreq(2 * count, DT)[1:]
    exact = encountered_sea(np.arange(4, 40) * 0.05, U, BETA, HULL)
    energy = np.interp(omega, exact.omega, exact.disturbance_energy(sea) / exact.width, left=0.0, right=0.0)
    slope = np.sqrt(energy * omega[0]) * (rng.standard_normal(len(omega)) + 1j * rng.standard_normal(len(omega)))
    response = loop.disturbance.frequency_response(omega)
    controller = loop.gain_values @ loop.controller_terms(omega) if is_controlled else 0.0 * omega
    output = response * slope / (1.0 + controller * loop.plant.frequency_response(omega))
    lines = np.stack([output, -controller * output], axis=1)
    series = np.fft.irfft(np.vstack([np.zeros((1, 2)), lines]) * count, axis=0)[:count]
    spectra = stretch_spectra(series, DT, SEGMENT).band_limited(0.2, 2.5).strong_band(0, 0.03)
    return WaveLeg(ObservedLeg(spectra, fin_loop()), encountered_sea(spectra.omega, U, BETA, HULL), 8.0)


def test_altered_loop_moves_frequency_damping_and_gain_alone() -> None:
    loop = altered_loop(fin_loop(), np.log([0.5, 1.1, 1.3]))
    before, after = fin_loop().plant.poles[0], loop.plant.poles[0]
    assert len(PLANT_FACTORS) == 3
    assert after.imag == pytest.approx(1.1 * before.imag)
    assert after.real == pytest.approx(1.1 * 1.3 * before.real)
    assert loop.plant.gain == pytest.approx(0.5 * fin_loop().plant.gain)
    assert loop.disturbance.gain == pytest.approx(fin_loop().disturbance.gain)


def test_gradient_is_that_of_the_cost() -> None:
    leg = _leg(1, np.log([2.0, 8.0, 1.0]), np.zeros(3), is_controlled=True)
    problem = LegsInWaves((leg, leg), PRIORS)
    point, none = problem.start() + 0.05, np.zeros((0, 0))
    steps = 1e-4 * np.eye(len(point))
    slopes = [(problem.cost(point + s, none) - problem.cost(point - s, none)) / 2e-4 for s in steps]
    np.testing.assert_allclose(problem.normal(point, none).gradient, slopes, rtol=1e-5, atol=1e-5)


def test_expected_spectra_give_back_ship_and_seas() -> None:
    """Where the densities are exactly those of the model, its point is the optimum: one ship, whatever control did."""
    seas, ship = [np.log([2.0, 8.0, 1.0]), np.log([2.1, 8.2, 1.0])], np.log([0.8, 1.03, 1.2])
    drawn = [_leg(k, sea, ship, is_controlled=bool(k)) for k, sea in enumerate(seas)]
    legs = tuple(_exact(leg, ship, sea) for leg, sea in zip(drawn, seas, strict=True))
    wide = LegPriors(np.full(3, 5.0), np.full(2, np.inf))
    cost = LegsInWaves(legs, wide).normal(np.concatenate([ship, *seas]), np.zeros((0, 0)))
    errors = np.sqrt(np.diag(np.linalg.inv(cost.hessian)))
    assert np.max(np.abs(np.linalg.solve(cost.hessian, cost.gradient)) / errors) < 0.1


def _exact(leg: WaveLeg, ship: Array, sea: Array) -> WaveLeg:
    """The leg with its outputs scaled to the model's density, its actuator to the same controller."""
    density = np.exp(leg.likelihood(ship, sea)[1])
    factor = np.sqrt(density / leg.observed.output_density)
    spectra = replace(leg.spectra, transforms=leg.spectra.transforms * factor[None, :, None])
    return replace(leg, observed=replace(leg.observed, spectra=spectra))


def test_simulated_legs_give_the_ship_within_its_errors() -> None:
    ship, misses = np.log([0.8, 1.03, 1.2]), []
    for seed in range(6):
        legs = [_leg(10 * seed + k, np.log([2.0, 8.0, 1.0]), ship, is_controlled=bool(k % 2)) for k in range(4)]
        fit = fit_legs(legs, PRIORS)
        assert fit.is_converged
        misses.append((fit.ship - ship) / fit.ship_deviations)
        assert abs(fit.seas[0, 0] - math.log(2.0)) < 4.0 * fit.sea_deviations(0)[0]
    # eighteen normal numbers, pulled a little towards the prior
    assert np.sqrt(np.mean(np.square(misses))) < 1.5


def test_a_factor_without_deviation_is_held() -> None:
    leg = _leg(3, np.log([2.0, 8.0, 1.0]), np.zeros(3), is_controlled=False)
    fit = fit_legs([leg], LegPriors(np.zeros(3), np.full(2, np.inf)))
    assert not fit.ship.any()
    assert fit.deviation(lambda ship, _: float(ship.sum())) == 0.0
    assert fit.seas[0, 1] == pytest.approx(math.log(8.0), abs=0.1)
