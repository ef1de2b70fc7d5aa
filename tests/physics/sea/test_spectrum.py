"""Spectra against their analytic moments; encounter in head and following seas."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.sea.spectrum import (
    Spectrum,
    bretschneider,
    ittc,
    ittc_two_parameter,
    jonswap,
    sea_state,
    speed_factor,
    wave_frequency,
)

ALL = [ittc(2.27), ittc_two_parameter(3.0, 8.0), bretschneider(3.0, 9.0), jonswap(3.0, 9.0), jonswap(1.0, 5.0, 1.0)]


@pytest.mark.parametrize("spectrum", ALL, ids=lambda s: s.name)
def test_moments_equal_the_integral(spectrum: Spectrum) -> None:
    omega = spectrum.modal_frequency * np.geomspace(0.25, 1e4, 200_001)
    for order in (-1, 0, 1, 2):
        integral = np.trapezoid(omega**order * spectrum.density(omega), omega)
        assert spectrum.moment(order) == pytest.approx(integral, rel=2e-7)


@given(height=st.floats(0.1, 15.0), period=st.floats(2.0, 20.0), gamma=st.floats(1.0, 7.0))
def test_height_and_period_come_back(height: float, period: float, gamma: float) -> None:
    assert jonswap(height, period, gamma).significant_height == pytest.approx(height, rel=1e-9)
    assert 2 * math.pi / bretschneider(height, period).modal_frequency == pytest.approx(period, rel=1e-12)
    two = ittc_two_parameter(height, period)
    assert two.significant_height == pytest.approx(height, rel=1e-12)
    assert two.mean_period == pytest.approx(period, rel=1e-12)


def test_the_band_of_the_paper_is_found() -> None:
    low, high = ittc(2.27).band()
    assert low == pytest.approx(0.544, abs=5e-4)
    assert high == pytest.approx(2.784, abs=5e-4)


def test_the_constants_of_the_towing_tank_conference_are_rounded() -> None:
    assert pytest.approx(691.0, rel=3e-4) == ittc_two_parameter(1.0, 1.0).B
    assert pytest.approx(173.0, rel=2e-3) == ittc_two_parameter(1.0, 1.0).A


@pytest.mark.parametrize("spectrum", ALL, ids=lambda s: s.name)
def test_shares_of_energy_and_their_inverse(spectrum: Spectrum) -> None:
    shares = np.array([0.01, 0.3, 0.9, 0.99])
    np.testing.assert_allclose(spectrum.share_below(spectrum.frequency_of_share(shares)), shares, rtol=1e-8)


@pytest.mark.parametrize("made", [lambda: ittc(0.0), lambda: bretschneider(2.0, -1.0), lambda: jonswap(2.0, 8.0, 0.5)])
def test_seas_out_of_sense_are_refused(made: object) -> None:
    with pytest.raises(InputError):
        made()  # type: ignore[operator]


def test_the_fourth_moment_does_not_exist() -> None:
    with pytest.raises(InputError, match="infinite"):
        ittc(2.0).moment(4)


def test_moments_of_the_published_spectrum_are_those_on_paper() -> None:
    """m0 = A / (4 B), m2 = A sqrt(pi / B) / 4; the height is 4 sqrt(8.1e-3 g^2 / 12.44) times the one put in."""
    A, B = 8.1e-3 * 9.81**2, 3.11 / 2.27**2
    assert ittc(2.27).moment(0) == pytest.approx(A / (4 * B), rel=1e-14)
    assert ittc(2.27).moment(2) == pytest.approx(A * math.sqrt(math.pi / B) / 4, rel=1e-14)
    assert ittc(2.27).significant_height == pytest.approx(2.27 * 4 * math.sqrt(8.1e-3 * 9.81**2 / 12.44), rel=1e-14)


@pytest.mark.parametrize("spectrum", ALL, ids=lambda s: s.name)
def test_energy_between_adds_up(spectrum: Spectrum) -> None:
    edges = spectrum.modal_frequency * np.array([0.0, 0.7, 0.99, 1.0, 1.2, 3.0, 1e4])
    parts = spectrum.energy_between(edges[:-1], edges[1:])
    assert (parts >= 0.0).all()
    assert parts.sum() == pytest.approx(spectrum.moment(0), rel=1e-14)


@pytest.mark.parametrize("gamma", [3.3, 7.0, 20.0])
def test_a_raised_peak_is_integrated_to_rounding(gamma: float) -> None:
    """Against adaptive quadrature between the peak's flanks."""
    spectrum = jonswap(3.0, 9.0, gamma)
    peak = spectrum.modal_frequency
    for start, stop in ((0.7, 0.93), (0.93, 1.0), (1.0, 1.1), (1.1, 2.5)):
        integral, _ = quad(lambda w: float(spectrum.density(w)), start * peak, stop * peak, epsabs=0.0, epsrel=1e-12)
        assert float(spectrum.energy_between(start * peak, stop * peak)) == pytest.approx(integral, rel=1e-10)


@pytest.mark.parametrize("shares", [(0.5, 0.2), (0.0, 0.9), (0.1, 1.0)])
def test_bands_without_sense_are_refused(shares: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="share"):
        ittc(2.0).band(*shares)


def test_every_sea_state_begins_where_the_last_ended() -> None:
    states = [sea_state(number) for number in range(10)]
    assert all(low.highest == high.lowest for low, high in pairwise(states))
    for state in states[2:9]:
        assert state.lowest < state.significant_height < state.highest
        assert state.spectrum().significant_height == pytest.approx(state.significant_height)
        assert 2 * math.pi / state.spectrum().modal_frequency == pytest.approx(state.modal_period)
    for number in (0, 1, 9):
        with pytest.raises(InputError, match="no typical height and period"):
            sea_state(number).spectrum()


def test_sea_state_four_has_the_height_between_its_limits() -> None:
    four = sea_state(4)
    assert four.lowest <= 2.27 <= four.highest
    with pytest.raises(InputError, match="no sea state 12"):
        sea_state(12)


def test_the_wave_of_a_head_sea_is_found_and_that_of_a_following_sea_refused() -> None:
    omega = np.array([0.5, 1.0, 2.5])
    np.testing.assert_allclose(wave_frequency(encounter_frequency(omega, 9.26, 2.4), 9.26, 2.4), omega)
    with pytest.raises(InputError, match="three waves"):
        wave_frequency(omega, 9.26, 0.5)


@pytest.mark.parametrize(("U", "beta", "said"), [(-1.0, 1.0, "knots"), (60.0, 1.0, "knots"), (9.0, 90.0, "degrees")])
def test_speed_and_heading_out_of_sense_are_refused(U: float, beta: float, said: str) -> None:
    with pytest.raises(InputError, match=said):
        speed_factor(U, beta)
