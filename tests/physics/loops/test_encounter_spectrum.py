"""What a sea does to a ship: against brute integration, Jacobian or none, one direction or many, and refusals."""

import importlib
import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import G
from seatrial.physics.loops import WAVE_SLOPE, Block, EncounterSpectrum, HullFactor, sea_disturbance
from seatrial.physics.loops.encounter_spectrum import disturbance_spectrum
from seatrial.physics.loops.structures import ROLL
from seatrial.physics.sea.spectrum import Spectrum, ittc, jonswap

HULL = HullFactor(100.0, 10.5, 3.4)
SEA = ittc(3.3)
RATE = Block("roll rate", (1.0, 0.0), ROLL.den)
MODULE = importlib.import_module("seatrial.physics.loops.encounter_spectrum")


def slope_density(spectrum: Spectrum, omega: Array, beta: float, hull: HullFactor | None) -> Array:
    k = omega**2 / G
    made = (k * math.sin(beta)) ** 2 * spectrum.density(omega)
    if hull is None:
        return made
    across, along = 0.5 * k * hull.B * math.sin(beta), 0.5 * k * hull.L * math.cos(beta)
    factor = np.exp(-0.5 * k * hull.T)
    for x in (across, along):
        factor = factor * np.where(np.abs(x) < 1e-9, 1.0, np.sin(x) / np.where(x == 0.0, 1.0, x))
    return made * factor**2


def brute(spectrum: Spectrum, U: float, beta: float, hull: HullFactor | None) -> Array:
    """Variances of roll and roll rate by Simpson over a million nodes of the wave frequency."""
    omega = np.linspace(0.2, 12.0 * spectrum.modal_frequency, 1_000_001)
    met = np.abs(omega - omega**2 * U * math.cos(beta) / G)
    density = np.abs(ROLL.frequency_response(met)) ** 2 * slope_density(spectrum, omega, beta, hull)
    weights = np.ones(len(omega))
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    step = (omega[1] - omega[0]) / 3.0
    return step * np.array([weights @ density, weights @ (met**2 * density)])


def variances(made: EncounterSpectrum) -> Array:
    return np.array([made.response_variance(ROLL), made.response_variance(RATE)])


@pytest.mark.parametrize("hull", [HULL, None], ids=["hull", "no hull"])
@pytest.mark.parametrize("U", [0.0, 6.0, 12.0])
@pytest.mark.parametrize("heading", [2, 40, 90, 150, 178])
def test_a_long_crested_sea_equals_brute_integration(heading: int, U: float, hull: HullFactor | None) -> None:
    beta = math.radians(heading)
    made = sea_disturbance(SEA, U, beta, ROLL, hull or WAVE_SLOPE)
    assert np.all(np.isfinite(made.energy))
    np.testing.assert_allclose(variances(made), brute(SEA, U, beta, hull), rtol=1e-7)


def test_a_raised_peak_equals_brute_integration_on_few_nodes() -> None:
    spectrum = jonswap(3.3, 9.1)
    made = sea_disturbance(spectrum, 9.0, math.radians(60.0), ROLL, HULL)
    np.testing.assert_allclose(variances(made), brute(spectrum, 9.0, math.radians(60.0), HULL), rtol=1e-7)
    assert len(made.omega_e) == 512


@pytest.mark.parametrize("heading", [20, 45, 70])
def test_a_following_sea_converges_without_a_jacobian(heading: int, monkeypatch: pytest.MonkeyPatch) -> None:
    beta, errors = math.radians(heading), []
    truth = brute(SEA, 9.26, beta, HULL)
    monkeypatch.setattr(MODULE, "_ACCURACY", math.inf)
    monkeypatch.setattr(MODULE, "_REDUCED_NODES", 2000)
    for count in (48, 96, 192, 384, 768, 1536):
        monkeypatch.setattr(MODULE, "_MIN_NODES", count)
        made = sea_disturbance(SEA, 9.26, beta, ROLL, HULL)
        assert len(made.omega_e) == count
        errors.append(np.abs(variances(made) / truth - 1.0).max())
    assert all(after < before or after < 1e-8 for before, after in pairwise(errors))
    assert errors[-1] < 1e-8


def test_a_beam_sea_is_the_slope_spectrum_whatever_the_speed() -> None:
    still, fast = (sea_disturbance(SEA, U, math.pi / 2.0, ROLL, HULL) for U in (0.0, 15.0))
    # cos(pi / 2) is a rounding error
    np.testing.assert_allclose(still.omega_e, fast.omega_e, rtol=1e-14)
    np.testing.assert_allclose(still.energy, fast.energy, rtol=1e-14)
    expected = quad(lambda w: slope_density(SEA, np.array([w]), math.pi / 2.0, HULL)[0], 0.2, 8.0, epsrel=1e-11)[0]
    assert still.variance == pytest.approx(expected, rel=1e-7)


@pytest.mark.long(every=4)
@pytest.mark.parametrize(
    ("heading", "exponent", "hull"),
    [
        (0, 1.0, HULL),
        (45, 1.0, HULL),
        (90, 1.0, HULL),
        (90, 8.0, HULL),
        (135, 25.0, HULL),
        (180, 2.0, HULL),
        (45, 1.0, None),
        (90, 8.0, None),
    ],
)
def test_a_short_crested_sea_equals_the_double_integral(heading: int, exponent: float, hull: HullFactor | None) -> None:
    U, beta = 9.26, math.radians(heading)
    made = sea_disturbance(SEA, U, beta, ROLL, hull or WAVE_SLOPE, spreading=exponent)
    nodes, weights = np.polynomial.legendre.leggauss(800)
    away = 0.5 * math.pi * nodes
    shares = weights * np.cos(away) ** (2.0 * exponent)
    omega = np.geomspace(0.25, 12.0 * SEA.modal_frequency, 2501)
    total = np.zeros(2)
    for angle, share in zip(away, shares / shares.sum(), strict=True):
        met = np.abs(omega - omega**2 * U * math.cos(beta + angle) / G)
        density = np.abs(ROLL.frequency_response(met)) ** 2 * slope_density(SEA, omega, beta + angle, hull)
        total += share * np.array([np.trapezoid(density, omega), np.trapezoid(met**2 * density, omega)])
    # a hull-less rate lives on the cut of the spectrum, which every direction meets elsewhere
    np.testing.assert_allclose(variances(made), total, rtol=1e-5 if hull else 2e-4)
    assert len(made.omega_e) <= 1024


def test_a_sea_of_little_spreading_is_nearly_long_crested() -> None:
    beta = math.radians(100.0)
    long, short = (
        sea_disturbance(SEA, 9.26, beta, ROLL, HULL, spreading=s).response_variance(ROLL) for s in (None, 2000.0)
    )
    assert short == pytest.approx(long, rel=2e-3)


@pytest.mark.parametrize("heading", [0, 180])
def test_a_long_crested_sea_along_the_ship_has_no_slope_and_is_refused(heading: int) -> None:
    with pytest.raises(InputError, match=f"no wave slope across the ship at a heading of {heading} deg; take another"):
        sea_disturbance(SEA, 9.26, math.radians(heading), ROLL, HULL)
    assert sea_disturbance(SEA, 9.26, math.radians(heading), ROLL, HULL, spreading=1.0).variance > 0.0


@pytest.mark.parametrize(
    ("U", "beta", "spreading", "said"),
    [
        (-1.0, 1.0, None, "ship speed"),
        (9.0, 4.0, None, "heading to the waves"),
        (9.0, 4.0, 1.0, "heading to the waves"),
        (90.0, 1.0, 1.0, "ship speed"),
        (9.0, 1.0, 0.0, "spreading exponent s .* must be positive, not 0"),
        (9.0, 1.0, math.nan, "spreading exponent s .* must be positive, not nan"),
    ],
)
def test_what_is_no_sea_is_refused(U: float, beta: float, spreading: float | None, said: str) -> None:
    with pytest.raises(InputError, match=said):
        sea_disturbance(SEA, U, beta, ROLL, HULL, spreading=spreading)


def test_the_sea_is_named_as_the_reader_knows_it() -> None:
    assert sea_disturbance(SEA, 9.0, math.pi / 2.0, ROLL, HULL).description == "ITTC one-parameter, 90 deg"
    assert (
        sea_disturbance(SEA, 9.0, 0.0, ROLL, HULL, spreading=1.0).description
        == "ITTC one-parameter, 0 deg, short-crested"
    )


def test_a_hull_feels_long_waves_as_they_are_and_short_ones_not() -> None:
    long, short = np.array([1e-3, 5e-3]), np.array([4.0, 6.0])
    for beta in (0.3, math.pi / 2.0, 2.0):
        np.testing.assert_allclose(HULL.slope_factor(long, beta), 1.0, atol=1e-4)
        assert np.all(np.abs(HULL.slope_factor(short, beta)) < 0.01)
    point = HullFactor(1e-9, 1e-9, 1e-9)
    np.testing.assert_allclose(point.slope_factor(short, 1.0), 1.0, atol=1e-7)


def test_a_hull_is_blind_to_waves_as_long_as_itself_along_its_axis() -> None:
    omega = np.array([math.sqrt(2.0 * math.pi * G / HULL.L), math.sqrt(2.0 * math.pi * G / HULL.B)])
    assert HULL.slope_factor(omega[:1], 0.0)[0] == pytest.approx(0.0, abs=1e-12)
    assert HULL.slope_factor(omega[1:], math.pi / 2.0)[0] == pytest.approx(0.0, abs=1e-12)


def test_over_nodes_equals_a_known_integral() -> None:
    made = disturbance_spectrum(lambda w: np.exp(-w), 1e-6, 60.0, Block("lag", (1.0,), (1.0, 1.0)), "decay")
    assert made.variance == pytest.approx(1.0, rel=1e-5)
    # int exp(-w) / (1 + w^2) = Ci(1) sin(1) + (pi / 2 - Si(1)) cos(1)
    assert made.response_variance(Block("lag", (1.0,), (1.0, 1.0))) == pytest.approx(0.6214496242, rel=2e-6)
