"""Sections by multipoles: the circle's known limits, Haskind's relation, symmetry; Lewis forms have their area."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.core.values import InputError
from seatrial.physics.hydro.section import (
    FRESH_WATER,
    MOTIONS,
    LewisForm,
    SectionMotion,
    haskind_damping,
    section_hydrodynamics,
)

G = 9.81
CIRCLE = LewisForm.from_dimensions(2.0, 1.0, np.pi / 4.0)
HALF_DISC = 0.5 * FRESH_WATER * np.pi


@dataclass(frozen=True)
class OneMotion:
    """What theory has of one motion alone."""

    added_mass: float
    damping: float
    excitation: complex
    radiated_amplitude: float


def at(nu: float, motion: SectionMotion, form: LewisForm = CIRCLE, axis: float = 0.0) -> OneMotion:
    made, k = section_hydrodynamics(form, float(np.sqrt(nu * G)), axis), MOTIONS.index(motion)
    return OneMotion(made.added_mass[k, k], made.damping[k, k], made.excitation[k], made.radiated_amplitude[k])


@given(st.floats(0.7, 1.6), st.floats(0.65, 0.99))
def test_a_lewis_form_has_the_beam_draught_and_area_asked_for(ratio: float, sigma: float) -> None:
    form = LewisForm.from_dimensions(2.0 * ratio, 1.0, sigma)
    theta = np.array([0.0, 0.5 * np.pi])
    x, y = form.points(theta)
    assert x == pytest.approx([0.0, ratio], abs=1e-12) and y == pytest.approx([1.0, 0.0], abs=1e-12)
    assert form.area == pytest.approx(2.0 * ratio * sigma, rel=1e-9)


def test_the_half_circle_is_a_lewis_form_without_corrections() -> None:
    assert pytest.approx([0.0, 0.0], abs=1e-12) == [CIRCLE.a1, CIRCLE.a3]


def test_long_waves_lift_the_circle_by_its_waterline() -> None:
    slow = at(1e-4, SectionMotion.HEAVE)
    assert slow.excitation.real == pytest.approx(-FRESH_WATER * G * 2.0, rel=1e-3)


def test_sway_of_the_circle_tends_to_the_double_body_at_low_frequency() -> None:
    assert at(1e-4, SectionMotion.SWAY).added_mass == pytest.approx(HALF_DISC, rel=1e-3)


def test_heave_of_the_circle_tends_to_the_double_body_at_high_frequency() -> None:
    values = [at(nu, SectionMotion.HEAVE).added_mass / HALF_DISC for nu in (2.0, 5.0, 10.0)]
    assert values == sorted(values) and 0.93 < values[-1] < 1.0


def test_a_circle_that_rolls_about_its_centre_moves_no_water() -> None:
    rolled = at(1.0, SectionMotion.ROLL)
    assert abs(rolled.added_mass) < 1e-9 and abs(rolled.excitation) < 1e-6


@settings(max_examples=25)
@given(st.floats(0.7, 1.5), st.floats(0.7, 1.0), st.floats(0.1, 3.0), st.sampled_from(list(SectionMotion)))
def test_damping_radiated_energy_and_excitation_agree(
    ratio: float, sigma: float, nu: float, motion: SectionMotion
) -> None:
    """Three independent ways: pressure on the contour, far field, Haskind through Green's theorem."""
    omega = float(np.sqrt(nu * G))
    one = at(nu, motion, LewisForm.from_dimensions(2.0 * ratio, 1.0, sigma), axis=0.3)
    far = FRESH_WATER * G**2 / omega * one.radiated_amplitude**2
    size = HALF_DISC * omega * (1.0 if motion is not SectionMotion.ROLL else 0.1)
    assert one.damping == pytest.approx(far, rel=0.01, abs=2e-3 * size)
    assert haskind_damping(abs(one.excitation), omega) == pytest.approx(far, rel=0.01, abs=2e-3 * size)


def test_moving_the_axis_of_roll_adds_sway() -> None:
    """Roll about z0 is roll about 0 less z0 times sway; the excitation follows."""
    about = [at(0.8, SectionMotion.ROLL, LewisForm.from_dimensions(2.0, 1.0, 0.95), z).excitation for z in (0.0, 0.4)]
    sway = at(0.8, SectionMotion.SWAY, LewisForm.from_dimensions(2.0, 1.0, 0.95)).excitation
    assert abs(about[1] - about[0] - 0.4 * sway) < 1e-6 * abs(sway) or abs(
        about[1] - about[0] + 0.4 * sway
    ) < 1e-6 * abs(sway)


def test_what_is_no_section_is_refused() -> None:
    with pytest.raises(InputError, match="no Lewis form"):
        LewisForm.from_dimensions(2.0, 1.0, 1.3)
    with pytest.raises(InputError, match="positive"):
        LewisForm.from_dimensions(-2.0, 1.0, 0.9)
    with pytest.raises(InputError, match="frequency"):
        section_hydrodynamics(CIRCLE, 0.0)


@settings(max_examples=25)
@given(st.floats(0.7, 1.5), st.floats(0.7, 1.0), st.floats(0.1, 3.0), st.floats(-0.5, 0.8))
def test_sway_and_roll_are_coupled_both_ways_alike_and_heave_with_neither(
    ratio: float, sigma: float, nu: float, axis: float
) -> None:
    """Radiation is reciprocal (Newman 1977, section 6.15), and one wave carries sway's and roll's energy away."""
    omega = float(np.sqrt(nu * G))
    made = section_hydrodynamics(LewisForm.from_dimensions(2.0 * ratio, 1.0, sigma), omega, axis)
    size = HALF_DISC * omega
    for matrix, unit in ((made.added_mass, HALF_DISC), (made.damping, size)):
        np.testing.assert_allclose(matrix, matrix.T, atol=4e-3 * unit)
        np.testing.assert_array_equal(matrix[1, [0, 2]], 0.0)
    b = made.damping
    assert b[0, 2] ** 2 == pytest.approx(b[0, 0] * b[2, 2], abs=0.01 * size**2)


@given(st.floats(0.2, 2.5), st.floats(-0.5, 0.8))
def test_another_axis_of_roll_is_roll_with_some_sway(nu: float, axis: float) -> None:
    """T' A T with roll about the axis z_0: sway of the origin less z_0 a radian."""
    form, omega = LewisForm.from_dimensions(2.0, 1.0, 0.95), float(np.sqrt(nu * G))
    about_origin, about_axis = (section_hydrodynamics(form, omega, z) for z in (0.0, axis))
    turned = np.array([[1.0, 0.0, axis], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    for name in ("added_mass", "damping"):
        expected = turned.T @ getattr(about_origin, name) @ turned
        np.testing.assert_allclose(getattr(about_axis, name), expected, atol=0.01 * HALF_DISC)
    np.testing.assert_allclose(about_axis.excitation, about_origin.excitation @ turned, rtol=1e-6, atol=1e-6)
