"""Speed terms: antisymmetric, undone again, seen in the published coefficients, consistent with the excitation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import G, encounter_frequency
from seatrial.physics.hydro.tabulated import coefficients_at_speed, excitation_at_speed

N = 5
OMEGA_E = np.array([-1.1, 0.3, 0.8, 1.7, 2.6])
matrices = arrays(np.float64, (N, 2, 2), elements=st.floats(-10.0, 10.0))
speeds = st.floats(0.0, 20.0)

# qi2025, Tables 2-4 (90, 135, 180 degrees, 18 kn), with the minus sign of b53 that the print drops
A33 = np.array([8.045e5, 6.311e5, 6.101e5])
PUBLISHED_A = np.array([[A33, [7.753e6, 3.281e6, 2.663e6]], [[1.479e7, 7.865e6, 6.611e6], [2.595e8, 1.525e8, 1.377e8]]])
B33 = np.array([9.369e5, 8.033e5, 7.400e5])
PUBLISHED_B = np.array(
    [[B33, [1.159e7, 9.429e6, 8.951e6]], [[-3.324e6, -2.267e6, -2.356e6], [2.885e8, 2.091e8, 1.873e8]]]
)


@given(matrices, matrices, speeds)
def test_the_terms_are_antisymmetric(A: np.ndarray, B: np.ndarray, U: float) -> None:
    """Coefficients symmetric at rest: what the speed adds to 35 it takes from 53, and heave keeps its own."""
    A, B = A + A.transpose(0, 2, 1), B + B.transpose(0, 2, 1)
    for rest, moving in zip((A, B), coefficients_at_speed(A, B, OMEGA_E, U), strict=True):
        added = moving - rest
        np.testing.assert_allclose(added[:, 0, 1], -added[:, 1, 0], rtol=1e-9, atol=1e-10)
        assert np.all(added[:, 0, 0] == 0.0)
    speedy = coefficients_at_speed(A, B, OMEGA_E, U)[1]
    np.testing.assert_allclose(speedy[:, 0, 1] - speedy[:, 1, 0], 2 * U * A[:, 0, 0], rtol=1e-9, atol=1e-9)


def test_published_coefficients_become_symmetric_at_rest() -> None:
    """The damping implies the ship's 18 kn at each heading, and at that speed the couplings come out symmetric."""
    A, B = np.moveaxis(PUBLISHED_A, 2, 0), np.moveaxis(PUBLISHED_B, 2, 0)
    implied = (B[:, 0, 1] - B[:, 1, 0]) / (2 * A33)
    np.testing.assert_allclose(implied, 18 * 1852 / 3600, rtol=1e-3)
    U = float(np.mean(implied))
    omega_e = np.sqrt(2 * U * B33 / (A[:, 1, 0] - A[:, 0, 1]))
    np.testing.assert_allclose(omega_e, [1.57, 1.80, 1.86], atol=0.01)
    moving = coefficients_at_speed(A, B, omega_e, U)
    A0, B0 = 2 * A - moving[0], 2 * B - moving[1]  # the terms depend on A33 and B33 alone, which stay
    np.testing.assert_allclose(A0[:, 0, 1], A0[:, 1, 0], rtol=1e-12)
    rounding = 5e3 + 5e2 + 2 * U * 50
    np.testing.assert_allclose(B0[:, 0, 1], B0[:, 1, 0], rtol=0.0, atol=rounding)
    assert np.all(A0[:, 1, 1] > 0) and np.all(B0[:, 1, 1] > 0)


@given(st.floats(0.0, 15.0), st.floats(0.0, np.pi), st.floats(0.0, 2e6))
def test_a_long_wave_carries_a_hull_at_any_speed(U: float, beta: float, a33: float) -> None:
    """A hull whose diffraction is the added mass times the water's acceleration: heave 1, pitch per slope 1."""
    omega = np.array([1e-3])
    omega_e, q = encounter_frequency(omega, U, beta), omega**2 / G * np.cos(beta)
    A, B = np.array([[[a33, 0.0], [0.0, 0.0]]]), np.zeros((1, 2, 2))
    C = np.array([[3e6, 5e6], [5e6, 6e8]])
    z_and_theta = np.column_stack([np.ones(1), 1j * q])
    froude_krylov = z_and_theta @ C.T
    diffraction = np.column_stack([-(omega**2) * a33, np.zeros(1)]).astype(complex)
    A, B = coefficients_at_speed(A, B, omega_e, U)
    force = excitation_at_speed(froude_krylov, diffraction, omega, omega_e, U)
    moved = np.linalg.solve(C - omega_e[0] ** 2 * A[0] + 1j * omega_e[0] * B[0], force[0])
    np.testing.assert_allclose(moved, z_and_theta[0], atol=1e-6 * omega[0] ** 2 / G)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"omega_e": np.array([1.0, 0.0])}, "zero"),
        ({"omega_e": np.array([1.0, np.nan])}, "finite"),
        ({"A": np.full((2, 2, 2), np.nan)}, "finite"),
        ({"A": np.ones((3, 2, 2))}, "shape"),
        ({"U": -2.0}, "speed"),
        ({"U": 80.0}, "knots"),
    ],
)
def test_bad_numbers_are_refused(change: dict, words: str) -> None:
    good = {"A": np.ones((2, 2, 2)), "B": np.ones((2, 2, 2)), "omega_e": np.array([1.0, 2.0]), "U": 5.0}
    with pytest.raises(InputError, match=words):
        coefficients_at_speed(**{**good, **change})


def test_excitation_needs_both_parts_alike() -> None:
    one, two = np.ones((2, 2), dtype=complex), np.ones((3, 2), dtype=complex)
    with pytest.raises(InputError, match="two columns"):
        excitation_at_speed(one, two, np.ones(3), np.ones(3), 1.0)
