"""Realisations: energy, repetition, seeds, spreading, and seas that a record cannot show."""

import math

import numpy as np
import pytest

from seatrial.hydro.excitation import BoxHull
from seatrial.sea.realise import (
    Spacing,
    realise,
    refuse_short,
    repetition_period,
    short_crested,
    wave_record,
)
from seatrial.sea.spectrum import ittc
from seatrial.values import InputError

SEA = ittc(2.27)
HULL = BoxHull(60.0, 7.14, 2.27, 3.15e6, 6.83e6, 6.83e6, 6.54e8)


@pytest.mark.parametrize("spacing", list(Spacing))
def test_the_energy_of_the_band_is_in_the_lines(spacing: Spacing) -> None:
    lines = realise(SEA, 9.26, 2.0, np.random.default_rng(1), count=400, spacing=spacing)
    assert np.sum(np.abs(lines.amplitude) ** 2) / 2 == pytest.approx(0.989 * SEA.moment(0), rel=1e-3)


def test_the_published_sea_repeats_after_84_s_abeam() -> None:
    lines = realise(SEA, 9.26, math.pi / 2, np.random.default_rng(0))
    period = repetition_period(lines)
    assert period == pytest.approx(84.0, abs=0.3)
    time = np.arange(0.0, 20.0, 0.1)

    def envelope(start: float) -> np.ndarray:
        return np.abs(np.exp(1j * np.outer(time + start, lines.encounter)) @ lines.amplitude)

    np.testing.assert_allclose(envelope(0.0), envelope(period), atol=1e-9)


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


def test_spreading_keeps_the_energy_and_stays_within_sense(rng: np.random.Generator) -> None:
    lines = realise(SEA, 9.26, math.radians(170), rng)
    spread = short_crested(lines, rng, exponent=2, directions=11)
    assert np.sum(np.abs(spread.amplitude) ** 2) == pytest.approx(np.sum(np.abs(lines.amplitude) ** 2))
    assert (spread.direction >= 0.0).all()
    assert (spread.direction <= math.pi).all()


def test_lines_above_nyquist_are_named() -> None:
    lines = realise(SEA, 9.26, math.pi, np.random.default_rng(0))
    with pytest.raises(InputError, match=r"2\.75 rad/s is met at 9\.87 rad/s"):
        wave_record(lines, np.arange(0.0, 100.0, 0.5))


def test_a_record_shorter_than_the_longest_wave_is_refused() -> None:
    lines = realise(SEA, 0.0, math.pi, np.random.default_rng(0))
    with pytest.raises(InputError, match="shorter than the longest period"):
        refuse_short(lines, 5.0)


@pytest.mark.parametrize(("band", "said"), [((0.001, 0.05), "no energy"), ((2.0, 1.0), "empty")])
def test_bands_without_sense_are_refused(band: tuple[float, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        realise(SEA, 0.0, 0.0, np.random.default_rng(0), band=band)
