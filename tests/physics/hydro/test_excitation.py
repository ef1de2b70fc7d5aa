"""The box-shaped hull and dispersion: limits, symmetries, signs, deep water."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import BoxHull, G, box_wave, encounter_frequency, group_velocity, wavenumber

HULL = BoxHull(L=60.0, B=7.14, T=2.27, c33=3.15e6, c35=6.83e6, c53=6.83e6, c55=6.54e8)
SPEED = 9.26
OMEGA = np.linspace(0.4, 2.8, 40)

headings = st.floats(0.0, np.pi)
speeds = st.floats(0.0, 20.0)


@given(headings, speeds, st.floats(-8e6, 8e6), st.floats(-8e6, 8e6))
def test_a_long_wave_carries_the_hull(beta: float, U: float, c35: float, c53: float) -> None:
    """Heave per wave and pitch per slope go to 1 for a plant of any stiffness; bow down is -d zeta / dx."""
    hull = BoxHull(L=60.0, B=7.14, T=2.27, c33=3.15e6, c35=c35, c53=c53, c55=6.54e8)
    omega = np.array([1e-4])
    F3, M5 = hull.forces(omega, U, beta)
    z, theta = np.linalg.solve([[hull.c33, c35], [c53, hull.c55]], [F3[0], M5[0]])
    slope = 1j * omega[0] ** 2 / G * np.cos(beta)
    assert abs(z - 1) < 1e-6
    assert abs(theta - slope) < 1e-5 * omega[0] ** 2 / G


def test_it_is_the_published_form() -> None:
    """F and G written as printed, away from their removable singularities."""
    beta, L, B, T = np.full(OMEGA.shape, 2.5), 60.0, 7.14, 2.27
    k = OMEGA**2 / G
    alpha = encounter_frequency(OMEGA, SPEED, beta) / OMEGA
    ke = np.abs(k * np.cos(beta))
    s, kappa = ke * L / 2, np.exp(-ke * T)
    A = 2 * np.sin(k * B * alpha**2 / 2) * np.exp(-k * T * alpha**2)
    f = np.sqrt((1 - k * T) ** 2 + (A**2 / (k * B * alpha**3)) ** 2)
    F = kappa * f * np.sin(s) / s
    Gs = kappa * f * 6 / (L * s) * (np.sin(s) / s - np.cos(s))
    elevation, slope = box_wave(OMEGA, SPEED, beta, L, B, T)
    np.testing.assert_allclose(elevation, F, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(slope, -Gs, rtol=1e-12, atol=1e-15)


def test_without_an_offset_the_force_is_in_phase_and_the_moment_in_quadrature() -> None:
    hull = BoxHull(L=60.0, B=7.14, T=2.27, c33=3.15e6, c35=0.0, c53=0.0, c55=6.54e8)
    F3, M5 = hull.forces(OMEGA, SPEED, np.pi)
    assert np.all(F3.imag == 0.0) and np.all(M5.real == 0.0)


def test_the_crest_at_the_bow_lifts_it() -> None:
    """Long head waves: the crest reaches the bow a quarter period before midship, and the moment is bow up then."""
    hull = BoxHull(L=60.0, B=7.14, T=2.27, c33=3.15e6, c35=0.0, c53=0.0, c55=6.54e8)
    omega = np.array([0.5])
    a_quarter_before, a_quarter_after = np.exp(-0.5j * np.pi), np.exp(0.5j * np.pi)
    head, following = hull.forces(omega, 0.0, np.pi)[1], hull.forces(omega, 0.0, 0.0)[1]
    assert (head * a_quarter_before).real < 0
    assert (following * a_quarter_after).real < 0


@given(headings, speeds)
def test_port_and_starboard_are_alike(beta: float, U: float) -> None:
    for one, other in zip(HULL.forces(OMEGA, U, beta), HULL.forces(OMEGA, U, -beta), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)


def test_ahead_and_astern_are_mirrored_at_rest() -> None:
    """Without speed and offset, following waves give the moment of head waves with the opposite sign."""
    hull = BoxHull(L=60.0, B=7.14, T=2.27, c33=3.15e6, c35=0.0, c53=0.0, c55=6.54e8)
    head, following = hull.forces(OMEGA, 0.0, np.pi - 0.3), hull.forces(OMEGA, 0.0, 0.3)
    np.testing.assert_allclose(head[0], following[0], rtol=1e-12)
    np.testing.assert_allclose(head[1], -following[1], rtol=1e-12)


def test_beam_waves_are_reached_without_a_step() -> None:
    at = HULL.forces(OMEGA, SPEED, np.pi / 2)
    for side in (-1e-9, 1e-9):
        near = HULL.forces(OMEGA, SPEED, np.pi / 2 + side)
        for a, b in zip(at, near, strict=True):
            assert np.max(np.abs(a - b)) < 1e-6 * np.max(np.abs(a))
    np.testing.assert_allclose(at[1], HULL.c53 / HULL.c33 * at[0], rtol=1e-9)


def test_a_wave_that_keeps_pace_is_no_exception() -> None:
    """alpha = 0: the wave travels with the ship."""
    omega = np.array([G / SPEED])
    F3, M5 = HULL.forces(omega, SPEED, 0.0)
    near = HULL.forces(omega * (1 + 1e-9), SPEED, 0.0)
    assert abs(encounter_frequency(omega, SPEED, 0.0)[0]) < 1e-12
    assert abs(F3 - near[0])[0] < 1e-6 * HULL.c33 and abs(M5 - near[1])[0] < 1e-6 * HULL.c55


def test_a_heading_for_each_wave() -> None:
    beta = np.linspace(0.0, np.pi, OMEGA.size)
    together = HULL.forces(OMEGA, SPEED, beta)
    for j in (0, 17, 39):
        alone = HULL.forces(OMEGA[j : j + 1], SPEED, float(beta[j]))
        assert together[0][j] == alone[0][0] and together[1][j] == alone[1][0]


@pytest.mark.parametrize(
    ("omega", "U", "beta", "words"),
    [
        ([0.0, 1.0], 0.0, 0.0, "positive"),
        ([1.0, np.nan], 0.0, 0.0, "NaN"),
        ([1.0], -1.0, 0.0, "speed"),
        ([1.0], np.nan, 0.0, "speed"),
        ([1.0], 70.0, 0.0, "knots"),
        ([1.0], 1.0, 180.0, "degrees"),
        ([1.0], 1.0, np.nan, "heading"),
        ([1.0, 2.0, 3.0], 1.0, [0.0, 1.0], "one heading"),
    ],
)
def test_waves_out_of_sense(omega: list[float], U: float, beta: float | list[float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        HULL.forces(np.array(omega), U, np.asarray(beta))


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [("L", 0.0, "positive L"), ("T", np.nan, "positive T"), ("c55", -1.0, "c55"), ("c35", np.inf, "finite c35")],
)
def test_hulls_out_of_sense(key: str, value: float, words: str) -> None:
    good = {"L": 60.0, "B": 7.14, "T": 2.27, "c33": 3.15e6, "c35": 0.0, "c53": 0.0, "c55": 6.54e8}
    with pytest.raises(InputError, match=words):
        BoxHull(**{**good, key: value})


def test_a_hull_without_a_stiff_way_is_refused() -> None:
    with pytest.raises(InputError, match="determinant"):
        BoxHull(60.0, 7.14, 2.27, 1.0, 2.0, 2.0, 1.0)


omegas, depths = st.floats(0.05, 20.0), st.floats(0.05, 500.0)


@given(omegas, depths)
def test_the_relation_holds_at_any_depth(omega: float, depth: float) -> None:
    k = float(wavenumber(omega, depth))
    assert G * k * np.tanh(k * depth) == pytest.approx(omega**2, rel=1e-10)


@given(omegas, depths)
def test_the_group_velocity_is_the_slope(omega: float, depth: float) -> None:
    step = 1e-5 * omega
    slope = 2.0 * step / float(wavenumber(omega + step, depth) - wavenumber(omega - step, depth))
    assert float(group_velocity(omega, depth)) == pytest.approx(slope, rel=1e-5)


def test_infinite_depth_is_the_limit() -> None:
    w = np.array([0.5, 2.0, 9.0])
    assert wavenumber(w, np.inf) == pytest.approx(w**2 / G)
    assert group_velocity(w, 1e4) == pytest.approx(0.5 * G / w)


def test_still_water_has_no_wave_number() -> None:
    with pytest.raises(InputError, match="positive frequencies"):
        wavenumber(0.0, 1.0)
