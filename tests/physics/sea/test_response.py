"""Responses: a cork follows the sea; a ship's point moves with heave and pitch; sickness as Lloyd has it."""

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.sea.realise import Spacing, realise
from seatrial.physics.sea.spectrum import ittc, jonswap
from seatrial.physics.sea.wave_forces import (
    MotionStatistics,
    motion_sickness,
    motion_statistics,
    response_spectrum,
    vertical_motion,
)

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


def test_amplitudes_of_a_narrow_sea_are_rayleigh() -> None:
    """Crests of a long realisation of a swell against exp(-a^2 / (2 m0)), and the largest in an hour."""
    swell = jonswap(2.0, 10.0, 20.0)
    lines = realise(swell, 0.0, np.pi, np.random.default_rng(8), count=2000, spacing=Spacing.JITTERED, band=(0.5, 0.8))
    omega = np.linspace(0.5, 0.8, 2001)
    motion = motion_statistics(swell, omega, omega, np.ones(2001, complex))
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
    assert (still.exceedance(0.1), motion_sickness(still)) == (0.0, 0.0)
    assert np.isinf(still.zero_crossing_period)


def test_operators_that_are_no_numbers_are_refused() -> None:
    broken = np.ones(len(OMEGA), complex)
    broken[7] = np.nan
    with pytest.raises(InputError, match="not a finite number"):
        motion_statistics(SEA, OMEGA, OMEGA, broken)
    with pytest.raises(InputError, match="one operator for each"):
        motion_statistics(SEA, OMEGA, OMEGA, broken[:5])
