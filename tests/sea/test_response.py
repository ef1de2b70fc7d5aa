"""Responses: a cork follows the sea; a ship's point moves with heave and pitch; sickness as Lloyd has it."""

import numpy as np
import pytest

from seatrial.sea.encounter import encounter_frequency
from seatrial.sea.response import Statistics, motion_sickness, statistics, vertical_motion
from seatrial.sea.spectrum import ittc
from seatrial.values import InputError

SEA = ittc(2.27)
OMEGA = np.geomspace(0.2, 20.0, 5000)


def test_a_cork_has_the_statistics_of_the_sea() -> None:
    cork = statistics(SEA, OMEGA, OMEGA, np.ones(len(OMEGA), complex))
    assert cork.significant == pytest.approx(0.5 * SEA.significant_height, rel=1e-3)
    assert cork.zero_crossing_period == pytest.approx(2 * np.pi * np.sqrt(SEA.moment(0) / SEA.moment(2)), rel=2e-3)
    assert cork.exceedance(cork.rms * np.sqrt(2 * np.log(2))) == pytest.approx(0.5)


def test_headway_shakes_more_in_head_seas_than_in_following() -> None:
    cork = np.ones(len(OMEGA), complex) * (OMEGA < 2.0)
    head, following = (
        statistics(SEA, OMEGA, encounter_frequency(OMEGA, 9.26, beta), cork).acceleration for beta in (np.pi, 0.0)
    )
    assert head > 3 * following


def test_a_point_ahead_falls_when_the_bow_goes_down() -> None:
    assert vertical_motion(np.zeros(1, complex), np.array([0.1 + 0j]), 20.0)[0] == pytest.approx(-2.0)


@pytest.mark.parametrize(("omega_e", "share"), [(1.07, 0.5), (3.0, 0.063)])
def test_sickness_depends_on_acceleration_and_frequency(omega_e: float, share: float) -> None:
    """At the worst frequency half of the people are sick where log10(a / g) = -.819."""
    a = 9.81 * 10**-0.819 / 0.798
    motion = Statistics(1.0, a**2 / omega_e**2, a**2)
    assert motion_sickness(motion) == pytest.approx(share, abs=0.04)


def test_a_band_beside_the_sea_is_refused() -> None:
    with pytest.raises(InputError, match="no energy"):
        statistics(SEA, OMEGA / 100, OMEGA, np.ones(len(OMEGA), complex))
