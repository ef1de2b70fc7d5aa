"""Responses: a cork follows the sea; a ship's point moves with heave and pitch; sickness as Lloyd has it."""

import numpy as np
import pytest
from scipy.special import ndtr

from seatrial.core.values import InputError
from seatrial.physics.sea.encounter import encounter_density, encounter_frequency
from seatrial.physics.sea.realise import Spacing, realise, short_crested
from seatrial.physics.sea.response import (
    MotionStatistics,
    motion_sickness,
    motion_sickness_after,
    motion_statistics,
    response_over_encounter,
    response_spectrum,
    statistics_of_components,
    vertical_acceleration,
    vertical_motion,
)
from seatrial.physics.sea.spectrum import ittc, jonswap

SEA = ittc(2.27)
OMEGA = np.geomspace(0.2, 20.0, 5000)


def test_a_cork_has_the_statistics_of_the_sea() -> None:
    cork = motion_statistics(SEA, OMEGA, OMEGA, np.ones(len(OMEGA), complex))
    assert cork.significant == pytest.approx(0.5 * SEA.significant_height, rel=1e-3)
    assert cork.zero_crossing_period == pytest.approx(2 * np.pi * np.sqrt(SEA.moment(0) / SEA.moment(2)), rel=2e-3)
    assert cork.exceedance(cork.rms * np.sqrt(2 * np.log(2))) == pytest.approx(0.5)


def test_headway_shakes_more_in_head_seas_than_in_following() -> None:
    cork = np.ones(len(OMEGA), complex) * (OMEGA < 2.0)
    head, following = (
        motion_statistics(SEA, OMEGA, encounter_frequency(OMEGA, 9.26, beta), cork).acceleration
        for beta in (np.pi, 0.0)
    )
    assert head > 3 * following


def test_a_point_ahead_falls_when_the_bow_goes_down() -> None:
    assert vertical_motion(np.zeros(1, complex), np.array([0.1 + 0j]), 20.0)[0] == pytest.approx(-2.0)


@pytest.mark.parametrize(("omega_e", "share"), [(1.07, 0.5), (3.0, 0.063)])
def test_sickness_depends_on_acceleration_and_frequency(omega_e: float, share: float) -> None:
    """At the worst frequency half of the people are sick where log10(a / g) = -.819."""
    a = 9.81 * 10**-0.819 / 0.798
    motion = MotionStatistics(1.0, a**2 / omega_e**2, a**2)
    assert motion_sickness(motion) == pytest.approx(share, abs=0.04)


def test_a_band_beside_the_sea_is_refused() -> None:
    with pytest.raises(InputError, match="no energy"):
        motion_statistics(SEA, OMEGA / 100, OMEGA, np.ones(len(OMEGA), complex))


def test_the_operator_decides_the_spectrum_of_the_response() -> None:
    np.testing.assert_allclose(response_spectrum(SEA, OMEGA, np.full(len(OMEGA), 2j)), 4.0 * SEA.density(OMEGA))


@pytest.mark.parametrize("beta", [0.0, 0.6, np.pi / 2, 2.0, np.pi])
def test_a_cork_over_encounter_has_the_spectrum_of_the_sea(beta: float) -> None:
    """As the exact energies of the branches have it, within the trapezoids of a fine grid; and nothing is lost."""
    omega, edges = np.linspace(0.3, 40.0, 200_001), np.linspace(0.0, 4.0, 31)
    felt = encounter_frequency(omega, 9.26, beta)
    binned = response_over_encounter(SEA.density(omega), omega, felt, edges)
    np.testing.assert_allclose(binned, encounter_density(SEA, 9.26, beta, edges), rtol=2e-3, atol=1e-6)
    wide = np.array([0.0, np.abs(felt).max()])
    whole = np.trapezoid(SEA.density(omega), omega)
    assert response_over_encounter(SEA.density(omega), omega, felt, wide)[0] * wide[1] == pytest.approx(whole, rel=1e-9)


def test_lines_have_the_statistics_of_their_spectrum() -> None:
    """Many lines of a head sea, a heave that dies out with omega: sums and integrals agree."""
    heave = 1.0 / (1.0 + 1j * OMEGA**4)
    felt = encounter_frequency(OMEGA, 5.0, np.pi)
    lines = realise(SEA, 5.0, np.pi, np.random.default_rng(3), count=4000, band=(0.3, 8.0))
    ours = statistics_of_components(lines, 1.0 / (1.0 + 1j * lines.omega**4))
    whole = motion_statistics(SEA, OMEGA, felt, heave)
    assert (ours.m0, ours.m2, ours.m4) == pytest.approx((whole.m0, whole.m2, whole.m4), rel=1e-3)


def test_spreading_lessens_the_shaking_of_head_seas() -> None:
    rng = np.random.default_rng(3)
    crests = realise(SEA, 9.26, np.pi, rng, count=300)
    cork = np.ones(300, complex)
    long, short = (statistics_of_components(lines, cork) for lines in (crests, short_crested(crests, rng)))
    assert short.m0 == pytest.approx(long.m0, rel=1e-12)
    assert short.m4 < 0.8 * long.m4


def test_acceleration_at_the_bow_is_that_of_its_motion() -> None:
    heave, pitch = 1.0 / (1.0 + 1j * OMEGA**4), 0.02j * OMEGA / (1.0 + OMEGA**5)
    felt = encounter_frequency(OMEGA, 9.26, 2.4)
    bow = motion_statistics(SEA, OMEGA, felt, vertical_motion(heave, pitch, 25.0))
    shaken = motion_statistics(SEA, OMEGA, felt, vertical_acceleration(heave, pitch, felt, 25.0))
    assert shaken.rms == pytest.approx(bow.acceleration, rel=1e-12)


def test_amplitudes_of_a_narrow_sea_are_rayleigh() -> None:
    """Crests of a long realisation of a swell against exp(-a^2 / (2 m0)), and the largest in an hour."""
    swell = jonswap(2.0, 10.0, 20.0)
    lines = realise(swell, 0.0, np.pi, np.random.default_rng(8), count=2000, spacing=Spacing.JITTERED, band=(0.5, 0.8))
    motion = statistics_of_components(lines, np.ones(2000, complex))
    zeta = lines.elevation(np.arange(0.0, 20000.0, 0.5))
    up = np.flatnonzero((zeta[:-1] < 0.0) & (zeta[1:] >= 0.0))
    crests = np.maximum.reduceat(zeta, up)[:-1]
    assert np.mean(np.diff(up)) * 0.5 == pytest.approx(motion.zero_crossing_period, rel=0.02)
    for level in (0.5, 1.0, 1.5, 2.0):
        assert np.mean(crests > level * motion.rms) == pytest.approx(motion.exceedance(level * motion.rms), abs=0.03)
    hour = motion.most_probable_maximum(3600.0)
    assert motion.exceedance(hour) == pytest.approx(motion.zero_crossing_period / 3600.0)
    with pytest.raises(InputError, match="no whole period"):
        motion.most_probable_maximum(5.0)


def test_without_motion_nobody_is_sick_and_nothing_is_exceeded() -> None:
    still = MotionStatistics(0.0, 0.0, 0.0)
    assert (still.exceedance(0.1), motion_sickness(still), motion_sickness_after(still, 120.0)) == (0.0, 0.0, 0.0)
    assert np.isinf(still.zero_crossing_period)


@pytest.mark.parametrize("rms", [0.05, 0.13, 0.3])
@pytest.mark.parametrize("f", [0.1, 0.167, 0.3])
@pytest.mark.parametrize("minutes", [10.0, 120.0])
def test_sickness_in_time_is_the_bivariate_normal_of_its_source(rms: float, f: float, minutes: float) -> None:
    """log10(a) ~ N(.87 + 4.36 F + 2.73 F^2, .47), log10(t) ~ N(1.46, .76), correlation -.75, F = log10(f)."""
    F, rho = np.log10(f), -0.75
    z_a = (np.log10(rms) - (0.87 + 4.36 * F + 2.73 * F**2)) / 0.47
    z_t = (np.log10(minutes) - 1.46) / 0.76
    share = ndtr(z_a) * ndtr((z_t - rho * z_a) / np.sqrt(1 - rho**2))
    omega_e, m4 = 2 * np.pi * f, (rms * 9.81) ** 2
    assert motion_sickness_after(MotionStatistics(1.0, m4 / omega_e**2, m4), minutes) == pytest.approx(share, abs=2e-3)


def test_sickness_grows_with_time_and_both_sources_agree_on_a_sine_at_two_hours() -> None:
    """A sine of .13 g rms at .167 Hz; its mean absolute acceleration is .900 of its rms, that of a sea .798."""
    omega_e, m4 = 2 * np.pi * 0.167, (0.13 * 9.81) ** 2
    motion = MotionStatistics(m4 / omega_e**4, m4 / omega_e**2, m4)
    shares = [motion_sickness_after(motion, minutes) for minutes in (1.0, 10.0, 60.0, 120.0)]
    assert shares == sorted(shares)
    as_sea = m4 * (0.9003 / 0.798) ** 2
    assert shares[-1] == pytest.approx(motion_sickness(MotionStatistics(1.0, as_sea / omega_e**2, as_sea)), abs=0.05)
    with pytest.raises(InputError, match="positive time"):
        motion_sickness_after(motion, 0.0)


def test_operators_that_are_no_numbers_are_refused() -> None:
    broken = np.ones(len(OMEGA), complex)
    broken[7] = np.nan
    with pytest.raises(InputError, match="not a finite number"):
        motion_statistics(SEA, OMEGA, OMEGA, broken)
    with pytest.raises(InputError, match="one operator for each"):
        motion_statistics(SEA, OMEGA, OMEGA, broken[:5])
