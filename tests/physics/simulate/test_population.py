"""Populations against SciPy, against each other, and against what physics allows."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.signal import lsim

from seatrial.core.values import Array, InputError
from seatrial.physics.models import heave_pitch_zoh
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.published import HEAVE_PITCH_STIFFNESSES as STIFFNESSES
from seatrial.physics.models.published import QI2025_SHIP, theoretical_coefficients
from seatrial.physics.simulate.population import (
    Forcing,
    affine_population_matrices,
    discretised_hold,
    discretised_ramp,
    fitness,
    one_sample_fitness,
    trajectories,
)

DT, SAMPLES = 0.5, 300
AT_REST, SIGMA = np.zeros(4), np.array([0.01, 3.5e-4])


def parameters_of(coefficients: Array) -> Array:
    """Parameters (count, 14) m I5 a33 a35 a55 a53 b33 b35 b55 b53 c33 c35 c53 c55 of the ship with these eight."""
    known = [QI2025_SHIP.particulars[name] for name in ("m", "I5", *STIFFNESSES)]
    columns = np.tile(known, (len(coefficients), 1))
    return np.concatenate([columns[:, :2], coefficients, columns[:, 2:]], axis=1)


def heave_pitch_matrices(parameters: Array) -> tuple[Array, Array]:
    """A and B of x' = A x + B (F3, M5), x = (z, z_dot, theta, theta_dot), written from Qi et al. 2025, eq. (1)."""
    A, B = np.zeros((len(parameters), 4, 4)), np.zeros((len(parameters), 4, 2))
    A[:, 0, 1] = A[:, 2, 3] = 1.0
    for k, (m, i5, a33, a35, a55, a53, b33, b35, b55, b53, c33, c35, c53, c55) in enumerate(parameters):
        determinant = (m + a33) * (i5 + a55) - a35 * a53
        with np.errstate(all="ignore"):
            inverse = np.array([[i5 + a55, -a35], [-a53, m + a33]]) / determinant
            A[k, 1::2] = -inverse @ np.array([[c33, b33, c35, b35], [c53, b53, c55, b55]])
        B[k, 1::2] = inverse
    return A, B


def plants(rng: np.random.Generator, count: int, spread: float = 0.3) -> tuple[Array, Array]:
    truth = np.array([theoretical_coefficients(90).values[name] for name in COEFFICIENTS])
    around = truth * (1.0 + spread * rng.uniform(-1.0, 1.0, (count, 8)))
    return heave_pitch_matrices(parameters_of(around))


def waves(rng: np.random.Generator, rows: int = SAMPLES) -> Array:
    return rng.normal(size=(rows, 2)).cumsum(axis=0) * [1e5, 1e6]


def van_loan(a: Array, b: Array, h: float) -> tuple[Array, Array, Array]:
    """Phi, Psi, G1 by one exponential of the block matrix (Van Loan 1978)."""
    n, m = b.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n], block[:n, n : n + m], block[n : n + m, n + m :] = a * h, b * h, np.eye(m)
    whole = expm(block)
    return whole[:n, :n], whole[:n, n : n + m], whole[:n, n + m :]


@pytest.mark.parametrize(("nx", "nu"), [(4, 2), (3, 1), (6, 4)])
@pytest.mark.parametrize("size", [0.01, 1.0])
def test_discrete_matrices_equal_the_block_exponential(nx: int, nu: int, size: float, rng: np.random.Generator) -> None:
    A, B = size * rng.normal(size=(11, nx, nx)), rng.normal(size=(11, nx, nu))
    phi, psi = discretised_hold(A, B, DT)
    ramped, G0, G1 = discretised_ramp(A, B, DT)
    for c in range(len(A)):
        E, held, ramp = van_loan(A[c], B[c], DT)
        for made, expected in ((phi, E), (ramped, E), (psi, held), (G0, held - ramp), (G1, ramp)):
            assert np.abs(made[c] - expected).max() <= 1e-13 * np.abs(expected).max()


def test_large_matrices_equal_the_exponential_in_forty_digits(rng: np.random.Generator) -> None:
    """Where SciPy's own rounding is larger (8e-13 of the largest entry) than ours."""
    A = 5.0 * rng.normal(size=(4, 4, 4))
    phi, _ = discretised_hold(A, np.zeros((4, 4, 1)), DT)
    for a, made in zip(A, phi, strict=True):
        with mpmath.workdps(40):
            expected = np.array(mpmath.expm(mpmath.matrix(a * DT), method="taylor").tolist(), dtype=float)
        assert np.abs(made - expected).max() <= 1e-13 * np.abs(expected).max()


@pytest.mark.parametrize("is_held", [True, False])
def test_trajectories_equal_lsim(is_held: bool, rng: np.random.Generator) -> None:
    A, B = plants(rng, 5)
    u, start = waves(rng), np.array([0.1, 0.0, -0.02, 0.01])
    y = trajectories(A, B, Forcing(u, DT, is_held), start)
    for c in range(len(A)):
        system = (A[c], B[c], np.eye(4)[[0, 2]], np.zeros((2, 2)))
        expected = lsim(system, u, np.arange(SAMPLES) * DT, start, interp=not is_held)[1]
        np.testing.assert_allclose(y[c], expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_substeps_are_samples_of_a_finer_run(rng: np.random.Generator) -> None:
    A, B = plants(rng, 3)
    u = waves(rng, 4 * 50 + 1)
    coarse = trajectories(A, B, Forcing(u, DT, is_held=False, substeps=4), AT_REST)
    fine = trajectories(A, B, Forcing(u, DT / 4, is_held=False), AT_REST)
    np.testing.assert_array_equal(coarse, fine[:, ::4])


@pytest.mark.parametrize("is_held", [True, False])
def test_fitness_is_the_sum_of_squared_residuals(is_held: bool, rng: np.random.Generator) -> None:
    A, B = plants(rng, 19)
    forcing = Forcing(waves(rng), DT, is_held)
    y = trajectories(A, B, forcing, AT_REST)
    measured = y[3] + rng.normal(size=y[3].shape) * SIGMA
    measured[40:60, 1] = np.nan
    expected = np.nansum(((y - measured) / SIGMA) ** 2, axis=(1, 2))
    np.testing.assert_allclose(fitness(A, B, forcing, AT_REST, measured, SIGMA), expected, rtol=1e-12)


@given(st.integers(1, 40), st.integers(0, 2**31))
@settings(max_examples=25, deadline=None)
def test_a_candidate_keeps_its_bits_among_any_neighbours(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    A, B = plants(rng, count)
    strange = rng.integers(count)
    A[strange] *= rng.choice([1.0, 30.0, 1e30, np.nan])
    forcing = Forcing(waves(rng, 60), DT, is_held=bool(rng.integers(2)))
    measured = rng.normal(size=(60, 2))
    together = fitness(A, B, forcing, AT_REST, measured, SIGMA)
    order = rng.permutation(count)
    np.testing.assert_array_equal(fitness(A[order], B[order], forcing, AT_REST, measured, SIGMA), together[order])
    alone = [fitness(A[c : c + 1], B[c : c + 1], forcing, AT_REST, measured, SIGMA)[0] for c in range(count)]
    np.testing.assert_array_equal(alone, together)


@given(st.integers(0, 2**31))
@settings(max_examples=25, deadline=None)
def test_energy_decays_without_input(seed: int) -> None:
    rng = np.random.default_rng(seed)

    def definite() -> Array:
        root = rng.normal(size=(9, 2, 2))
        return root @ root.transpose(0, 2, 1) + 0.1 * np.eye(2)

    M, D, C = definite(), definite(), definite()
    A = np.zeros((9, 4, 4))
    A[:, 0, 1] = A[:, 2, 3] = 1.0
    A[:, 1::2, 0::2], A[:, 1::2, 1::2] = -np.linalg.solve(M, C), -np.linalg.solve(M, D)
    x = trajectories(
        A, np.zeros((9, 4, 2)), Forcing(np.zeros((80, 2)), 0.2, is_held=True), rng.normal(size=4), (0, 1, 2, 3)
    )
    position, speed = x[:, :, 0::2], x[:, :, 1::2]
    energy = np.einsum("cki,cij,ckj->ck", speed, M, speed) + np.einsum("cki,cij,ckj->ck", position, C, position)
    assert np.all(np.diff(energy, axis=1) <= 1e-12 * energy[:, :1])


def test_what_cannot_be_simulated_has_infinite_fitness(rng: np.random.Generator) -> None:
    parameters = parameters_of(np.full((5, 8), 1e5))
    parameters[1, 2] = np.nan
    parameters[2, 6:10] = -1e12
    parameters[3, 2], parameters[3, 3], parameters[3, 4], parameters[3, 5] = (
        -QI2025_SHIP.particulars["m"],
        0.0,
        0.0,
        0.0,
    )
    parameters[4, 10] = np.inf
    A, B = heave_pitch_matrices(parameters)
    for is_held in (True, False):
        forcing = Forcing(waves(rng), DT, is_held)
        found = fitness(A, B, forcing, AT_REST, np.zeros((SAMPLES, 2)), SIGMA)
        assert np.isfinite(found[0])
        assert np.all(found[1:] == np.inf)


def test_one_sample_fitness_is_one_step(rng: np.random.Generator) -> None:
    A, B = plants(rng, 12)
    u, state, seen = waves(rng), np.array([0.2, 0.1, 0.01, 0.02]), np.array([0.3, 0.02])
    phi, psi = discretised_hold(A, B, DT)
    after = (phi @ state + psi @ u[17])[:, [0, 2]]
    found = one_sample_fitness(A, B, Forcing(u, DT, is_held=True), 17, state, seen, SIGMA)
    np.testing.assert_allclose(found, (((after - seen) / SIGMA) ** 2).sum(axis=1), rtol=1e-11)


def test_the_models_own_code_gives_the_matrices_of_the_equations_of_motion(rng: np.random.Generator) -> None:
    model = theoretical_coefficients(90).applied_to(heave_pitch_zoh())
    points = rng.uniform(1e5, 1e6, (7, 8))
    parameters = np.tile(model.parameters.values, (7, 1))
    parameters[:, [model.parameters.index(name) for name in COEFFICIENTS]] = points
    expected = heave_pitch_matrices(parameters_of(points))
    for found, known in zip(affine_population_matrices(model, parameters, (0, 1)), expected, strict=True):
        np.testing.assert_allclose(found, known, rtol=1e-9, atol=1e-18)


def test_a_held_input_is_constant_between_rows_while_the_others_run_straight(rng: np.random.Generator) -> None:
    A, B = plants(rng, 3)
    u = waves(rng, 9)
    mixed = Forcing(u, DT, is_held=False, held_columns=(1,))
    straight, held = u * [1.0, 0.0], u * [0.0, 1.0]
    apart = trajectories(A, B, Forcing(straight, DT, is_held=False), AT_REST)
    apart += trajectories(A, B, Forcing(held, DT, is_held=True), AT_REST)
    np.testing.assert_allclose(trajectories(A, B, mixed, AT_REST), apart, rtol=1e-9, atol=1e-12)
    assert mixed.one_step(2).held_columns == (1,)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"measured": np.zeros((7, 2))}, "measured has shape"),
        ({"measured": np.full((SAMPLES, 2), np.nan)}, "no channel has a measured sample"),
        ({"sigma": np.array([1.0, 0.0])}, "sigma must be positive"),
        ({"start": np.full(4, np.nan)}, "start must be finite"),
        ({"channels": (0, 4)}, "are no states"),
        ({"B": np.zeros((3, 4, 3))}, "want 3 inputs"),
        ({"B": np.zeros((2, 4, 2))}, "do not fit"),
    ],
)
def test_what_does_not_fit_is_refused(change: dict[str, object], words: str, rng: np.random.Generator) -> None:
    A, B = plants(rng, 3)
    arguments = {
        "A": A, "B": B, "forcing": Forcing(waves(rng), DT, is_held=True), "start": AT_REST,
        "measured": np.zeros((SAMPLES, 2)), "sigma": SIGMA,
    } | change  # fmt: skip
    with pytest.raises(InputError, match=words):
        fitness(**arguments)


@pytest.mark.parametrize(
    ("rows", "dt", "substeps", "words"),
    [(10, DT, 4, "whole number of samples"), (9, 0.0, 4, "positive"), (1, DT, 1, "whole number")],
)
def test_a_forcing_that_makes_no_sense_is_refused(rows: int, dt: float, substeps: int, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Forcing(np.zeros((rows, 2)), dt, is_held=True, substeps=substeps)


def test_a_gap_in_the_forcing_is_refused() -> None:
    u = np.zeros((9, 2))
    u[4, 1] = np.nan
    with pytest.raises(InputError, match="row 4"):
        Forcing(u, DT, is_held=True)
