"""Encounter: the three waves of a following sea, and energy that no heading loses."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import InputError
from seatrial.physics.sea.encounter import encounter_density, encounter_frequency, wave_frequency, waves_at_encounter
from seatrial.physics.sea.spectrum import ittc, jonswap


@pytest.mark.parametrize("heading", range(0, 181, 15))
@pytest.mark.parametrize("spectrum", [ittc(2.27), jonswap(3.0, 9.0)], ids=["ittc", "jonswap"])
def test_no_energy_is_lost_at_any_heading(spectrum, heading: int) -> None:
    edges = np.concatenate([[0.0], np.geomspace(1e-4, 1e6, 3000)])
    density = encounter_density(spectrum, 9.26, math.radians(heading), edges)
    assert density.min() >= -1e-12
    assert float(density @ np.diff(edges)) == pytest.approx(spectrum.moment(0), rel=1e-6)


@given(omega_e=st.floats(0.01, 5.0), U=st.floats(0.0, 20.0), beta=st.floats(0.0, math.pi))
def test_every_wave_met_has_that_frequency_of_encounter(omega_e: float, U: float, beta: float) -> None:
    found = np.array(waves_at_encounter(omega_e, U, beta))
    assert 1 <= len(found) <= 3
    np.testing.assert_allclose(np.abs(encounter_frequency(found, U, beta)), omega_e, rtol=1e-6, atol=1e-9)


def test_a_following_sea_has_three_waves_below_the_turning_point_and_one_above() -> None:
    q = 9.26 / 9.81
    assert len(waves_at_encounter(0.9 / (4 * q), 9.26, 0.0)) == 3
    assert len(waves_at_encounter(1.1 / (4 * q), 9.26, 0.0)) == 1


def test_the_wave_of_a_head_sea_is_found_and_that_of_a_following_sea_refused() -> None:
    omega = np.array([0.5, 1.0, 2.5])
    np.testing.assert_allclose(wave_frequency(encounter_frequency(omega, 9.26, 2.4), 9.26, 2.4), omega)
    with pytest.raises(InputError, match="three waves"):
        wave_frequency(omega, 9.26, 0.5)


@pytest.mark.parametrize(("U", "beta", "said"), [(-1.0, 1.0, "knots"), (60.0, 1.0, "knots"), (9.0, 90.0, "degrees")])
def test_speed_and_heading_out_of_sense_are_refused(U: float, beta: float, said: str) -> None:
    with pytest.raises(InputError, match=said):
        waves_at_encounter(1.0, U, beta)


@pytest.mark.parametrize("beta", [0.0, 0.4, math.pi / 2, 2.5, math.pi])
def test_bins_hold_the_energy_of_the_waves_that_are_met_in_them(beta: float) -> None:
    """Against brute force: narrow intervals of waves, each put whole into the bin of its own |omega_e|.

    The two edges of a bin cut at most three of them each.
    """
    spectrum, edges = ittc(2.27), np.linspace(0.0, 4.0, 41)
    cuts = np.linspace(0.2, 60.0, 2_000_001)
    energy = spectrum.energy_between(cuts[:-1], cuts[1:])
    felt = np.abs(encounter_frequency(0.5 * (cuts[1:] + cuts[:-1]), 9.26, beta))
    counted, _ = np.histogram(felt, edges, weights=energy)
    density = encounter_density(spectrum, 9.26, beta, edges)
    np.testing.assert_allclose(density * np.diff(edges), counted, atol=6 * energy.max())


def test_at_the_turning_point_two_waves_are_met() -> None:
    assert waves_at_encounter(0.25, 9.81, 0.0) == pytest.approx((0.5, 0.5 + math.sqrt(0.5)))
    assert len(waves_at_encounter(0.25, 9.81, 0.0)) == 2


@pytest.mark.parametrize("edges", [[1.0], [0.0, 2.0, 1.0], [-1.0, 1.0], [0.0, math.inf], [0.0, math.nan]])
def test_edges_out_of_order_are_refused(edges: list[float]) -> None:
    with pytest.raises(InputError, match="rising from zero"):
        encounter_density(ittc(2.0), 5.0, 1.0, np.array(edges))


@pytest.mark.parametrize("omega_e", [0.0, -1.0, math.nan, math.inf])
def test_a_frequency_of_encounter_that_is_none_is_refused(omega_e: float) -> None:
    with pytest.raises(InputError, match="must be positive"):
        waves_at_encounter(omega_e, 5.0, 1.0)
