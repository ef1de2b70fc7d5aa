"""Realisations: energy, repetition, seeds, spreading, and seas that a record cannot show."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import BoxHull
from seatrial.physics.sea.realise import (
    Spacing,
    WaveComponents,
    above_nyquist,
    realise,
    refuse_short_record,
    short_crested,
    spread_angle,
    wave_record,
)
from seatrial.physics.sea.spectrum import ittc

SEA = ittc(2.27)
HULL = BoxHull(60.0, 7.14, 2.27, 3.15e6, 6.83e6, 6.83e6, 6.54e8)


@pytest.mark.parametrize("spacing", list(Spacing))
def test_the_energy_of_the_band_is_in_the_lines(spacing: Spacing) -> None:
    lines = realise(SEA, 9.26, 2.0, np.random.default_rng(1), count=400, spacing=spacing)
    assert np.sum(np.abs(lines.amplitude) ** 2) / 2 == pytest.approx(0.989 * SEA.moment(0), rel=1e-3)


def test_the_same_seed_gives_the_same_sea() -> None:
    one, two = (realise(SEA, 9.26, 2.0, np.random.default_rng(5), spacing=Spacing.JITTERED) for _ in range(2))
    assert np.array_equal(one.amplitude, two.amplitude)
    assert np.array_equal(one.omega, two.omega)


def test_a_record_has_the_variance_of_its_lines_and_the_forces_of_the_hull() -> None:
    lines = realise(SEA, 9.26, math.radians(135), np.random.default_rng(2))
    record = wave_record(lines, np.arange(0.0, 4000.0, 0.2), HULL)
    assert np.var(record["zeta"]) == pytest.approx(np.sum(np.abs(lines.amplitude) ** 2) / 2, rel=0.03)
    forces = np.abs(lines.forces(HULL)) ** 2
    assert np.var(record["F3"]) == pytest.approx(forces[:, 0].sum() / 2, rel=0.03)
    assert np.var(record["M5"]) == pytest.approx(forces[:, 1].sum() / 2, rel=0.03)


@pytest.mark.parametrize("heading", [0.0, 95.0, 170.0])
def test_spreading_keeps_the_energy_and_stays_within_sense(heading: float, rng: np.random.Generator) -> None:
    lines = realise(SEA, 9.26, math.radians(heading), rng, count=300)
    spread = short_crested(lines, rng, 2.0)
    assert np.array_equal(spread.amplitude, lines.amplitude)
    assert (spread.direction >= 0.0).all()
    assert (spread.direction <= math.pi).all()


@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.0, 10.0])
def test_directions_hold_equal_shares_of_a_spreading_that_integrates_to_one(exponent: float) -> None:
    """The density of the directions, differences of shares over differences of angles, is the normalised cos^2s."""
    edges = spread_angle(np.linspace(0.0, 1.0, 2001), exponent)
    assert edges[0] == pytest.approx(-math.pi / 2)
    assert edges[-1] == pytest.approx(math.pi / 2)
    middle = 0.5 * (edges[1:] + edges[:-1])
    scale = math.gamma(exponent + 1.0) / (math.sqrt(math.pi) * math.gamma(exponent + 0.5))
    inner = slice(20, -20)
    density = 1.0 / 2000 / np.diff(edges)
    np.testing.assert_allclose(density[inner], scale * np.cos(middle[inner]) ** (2 * exponent), rtol=2e-2)
    whole, _ = quad(lambda chi: scale * math.cos(chi) ** (2 * exponent), -math.pi / 2, math.pi / 2)
    assert whole == pytest.approx(1.0, rel=1e-9)


def test_a_short_crested_sea_has_its_energy_in_every_realisation_at_rest_too() -> None:
    """Lines of one frequency and several directions would interfere; here each seed gives the same variance."""
    time = np.arange(0.0, 6000.0, 0.5)
    for seed in range(3):
        rng = np.random.default_rng(seed)
        lines = short_crested(realise(SEA, 0.0, 2.0, rng, count=60), rng)
        assert np.var(lines.elevation(time)) == pytest.approx(lines.variance, rel=0.01)


def test_lines_above_nyquist_are_named() -> None:
    lines = realise(SEA, 9.26, math.pi, np.random.default_rng(0))
    with pytest.raises(InputError, match=r"2\.75 rad/s is met at 9\.87 rad/s"):
        wave_record(lines, np.arange(0.0, 100.0, 0.5))


def test_a_record_shorter_than_the_longest_wave_is_refused() -> None:
    lines = realise(SEA, 0.0, math.pi, np.random.default_rng(0))
    for made in (lambda: refuse_short_record(lines, 5.0), lambda: wave_record(lines, np.arange(0.0, 5.0, 0.1))):
        with pytest.raises(InputError, match="too short for its longest wave"):
            made()
    refuse_short_record(lines, 11.0)


def test_in_following_seas_only_the_longest_wave_has_to_pass() -> None:
    lines = realise(SEA, 9.26, 0.0, np.random.default_rng(0), count=200)
    assert 2 * math.pi / np.abs(lines.omega_e).min() > 600.0
    refuse_short_record(lines, 60.0)


def test_all_lines_above_nyquist_are_stated() -> None:
    lines = realise(SEA, 9.26, math.pi, np.random.default_rng(0))
    beyond = above_nyquist(lines, 0.5)
    assert 1 < beyond.size < len(lines.omega)
    assert np.abs(lines.omega_e[beyond]).min() > 2 * math.pi
    assert np.abs(np.delete(lines.omega_e, beyond)).max() <= 2 * math.pi
    with pytest.raises(InputError, match=f"{beyond.size} lines lie above"):
        wave_record(lines, np.arange(0.0, 100.0, 0.5))


def test_the_elevation_is_the_sum_of_its_cosines() -> None:
    lines = WaveComponents(np.array([0.5, 1.2]), np.array([1.0, 0.5j]), np.array([math.pi, 0.5]), 3.0)
    time = np.linspace(0.0, 30.0, 50)
    first, second = lines.omega_e
    np.testing.assert_allclose(lines.elevation(time), np.cos(first * time) - 0.5 * np.sin(second * time), atol=1e-12)
    assert lines.variance == pytest.approx(0.625)


def test_a_sea_without_lines_is_refused() -> None:
    with pytest.raises(InputError, match="at least one line"):
        realise(SEA, 0.0, 0.0, np.random.default_rng(0), count=0)


@pytest.mark.parametrize(("band", "said"), [((0.001, 0.05), "no energy"), ((2.0, 1.0), "empty")])
def test_bands_without_sense_are_refused(band: tuple[float, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        realise(SEA, 0.0, 0.0, np.random.default_rng(0), band=band)
