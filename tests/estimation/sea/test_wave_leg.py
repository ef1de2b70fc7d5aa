"""One leg in waves: the controller that it shows, and the gradient of its likelihood."""

import math

import numpy as np
import pytest

from seatrial.estimation.sea import ObservedLeg, StretchSpectra, WaveLeg, altered_loop, encountered_sea
from seatrial.estimation.sea.wave_leg import STEP, altered_responses
from seatrial.physics.loops import HullFactor
from seatrial.physics.loops.structures import fin_loop

HULL, U, BETA = HullFactor(100.0, 10.5, 3.4), 9.26, math.radians(60.0)
SHIP, SEA = np.log([1.1, 1.03, 0.9]), np.log([3.0, 9.8, 1.0])
OMEGA = np.arange(8, 60) * 0.035  # rad/s, a segment of three minutes


def observed() -> ObservedLeg:
    """A leg without control whose spectrum is that of the truth, twelve segments of random phases."""
    loop, rng = altered_loop(fin_loop(), SHIP), np.random.default_rng(5)
    sea = encountered_sea(OMEGA, U, BETA, HULL)
    density = sea.density(SEA, np.abs(loop.disturbance.frequency_response(sea.omega_e)) ** 2)
    size = np.sqrt(density / 2.0)
    roll = size * (rng.standard_normal((12, len(OMEGA))) + 1j * rng.standard_normal((12, len(OMEGA))))
    return ObservedLeg(StretchSpectra(OMEGA, np.stack([roll, 1e-9 * roll], axis=2)), fin_loop())


def test_the_controller_is_that_of_the_actuator() -> None:
    loop = fin_loop().with_gains(np.array([11.0, 0.4, 33.0]))
    roll = observed().spectra.transforms[:, :, :1]
    controller = loop.gain_values @ loop.controller_terms(OMEGA)
    leg = ObservedLeg(StretchSpectra(OMEGA, np.concatenate([roll, -controller[:, None] * roll], axis=2)), fin_loop())
    np.testing.assert_allclose(leg.controller, controller, rtol=1e-2)
    assert np.max(leg.independent_actuator) < 1e-3 * np.max(leg.spectra.cross_density(1, 1).real)


def test_gradient_of_one_leg_is_that_of_its_likelihood() -> None:
    leg = WaveLeg(observed(), encountered_sea(OMEGA, U, BETA, HULL), 9.0)
    gradient = leg.equations(SHIP, SEA)[0]
    steps = STEP * np.eye(3)
    slopes = [(leg.likelihood(SHIP, SEA + s)[0] - leg.likelihood(SHIP, SEA - s)[0]) / (2.0 * STEP) for s in steps]
    assert gradient[3:] == pytest.approx(slopes)


@pytest.mark.parametrize("name", ["plant", "disturbance"])
def test_responses_of_many_ships_are_those_of_each(name: str) -> None:
    ships = np.array([SHIP, np.zeros(3), [0.0, -0.2, 0.4]])
    each = [getattr(altered_loop(fin_loop(), np.array([0.0, *ship[1:]])), name) for ship in ships]
    expected = [block.frequency_response(OMEGA) for block in each]
    np.testing.assert_allclose(altered_responses(getattr(fin_loop(), name), OMEGA, ships[:, 1:]), expected, rtol=1e-12)
