"""JONSWAP and Pierson-Moskowitz as wavespectra 4.9.0 has them: values of `benchmarks/against_wavespectra.py`.

`construct.frequency.jonswap` and `pierson_moskowitz`, 299 001 frequencies from .01 to 3 Hz, scaled by their sum.
"""

import math

import pytest

from seatrial.physics.sea.spectrum import Spectrum, bretschneider, jonswap

PM, YOUNG = bretschneider(3.0, 10.0), jonswap(3.0, 10.0, 3.3)
SMALL, STEEP = jonswap(0.88, 6.25, 1.7), jonswap(7.5, 15.0, 7.0)
LAST = 3.0

# spectrum, frequency [Hz], density [m^2/Hz]
DENSITIES = [
    (PM, 0.09, 7.087013752536),
    (PM, 0.1, 8.05794741162),
    (PM, 0.11, 7.436060026819),
    (PM, 0.3, 0.1139683293857),
    (YOUNG, 0.09, 7.146695363647),
    (YOUNG, 0.1, 17.43745742629),
    (YOUNG, 0.11, 9.284916241547),
    (YOUNG, 0.3, 0.07473584923669),
    (SMALL, 0.144, 0.3923914810831),
    (SMALL, 0.16, 0.6264188828366),
    (SMALL, 0.176, 0.4527310235434),
    (SMALL, 0.48, 0.005211655168837),
    (STEEP, 0.06, 60.21230109452),
    (STEEP, 0.06667, 237.646026379),
    (STEEP, 0.07333, 89.56040162526),
    (STEEP, 0.2, 0.4801671130783),
]
# spectrum, tm01 [s], tm02 [s]
PERIODS = [
    (PM, 7.71807014533, 7.10868532195),
    (YOUNG, 8.34355297400, 7.77827068266),
    (SMALL, 4.98624504383, 4.61520874165),
    (STEEP, 13.1622175886, 12.4298310591),
]


@pytest.mark.parametrize(("spectrum", "f", "density"), DENSITIES)
def test_the_density_is_theirs(spectrum: Spectrum, f: float, density: float) -> None:
    assert 2 * math.pi * float(spectrum.density(2 * math.pi * f)) == pytest.approx(density, rel=1e-9)


@pytest.mark.parametrize(("spectrum", "tm01", "tm02"), PERIODS)
def test_mean_periods_are_theirs_as_far_as_their_grid_goes(spectrum: Spectrum, tm01: float, tm02: float) -> None:
    """Beyond the last frequency the spectrum is A / omega^5, whose moments are taken off."""
    omega = 2 * math.pi * LAST
    m0, m1, m2 = (spectrum.moment(n) - spectrum.A * omega ** (n - 4) / (4 - n) for n in (0, 1, 2))
    assert 2 * math.pi * m0 / m1 == pytest.approx(tm01, rel=1e-7)
    assert 2 * math.pi * math.sqrt(m0 / m2) == pytest.approx(tm02, rel=1e-7)
