"""Linear models: propagators, runs, sensitivities."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.linalg import expm, expm_frechet

from seatrial.core.equations import Model
from seatrial.numerics.kernels.integrate import evaluate_tangent
from seatrial.numerics.kernels.linear import affine_matrices, affine_population, propagators
from seatrial.numerics.kernels.linear_population import discretise, misfit, trajectories

# Linear models: their matrices, exact discretisation of many at once, and the misfit of a whole population.

COUNT, STEP = 11, 0.2  # candidates: one full block of lanes and a rest; step [s]


def test_matrices_and_their_slopes_come_out_of_the_code(oscillator: Model) -> None:
    k, c, b = oscillator.parameters.values
    value, slope = affine_matrices(oscillator.compiled.rates_tangent, 2, 2, 1, np.arange(3), np.array([k, c, b]))
    np.testing.assert_allclose(value, [[0.0, 1.0, 0.0, 0.0], [-k, -c, b, 0.0]], atol=1e-15)
    expected = np.zeros((3, 2, 4))
    expected[0, 1, 0], expected[1, 1, 1], expected[2, 1, 2] = -1.0, -1.0, 1.0
    np.testing.assert_allclose(slope, expected, atol=1e-15)


def test_matrices_of_many_parameter_sets_are_those_of_each(oscillator: Model, rng: np.random.Generator) -> None:
    parameters = rng.standard_normal((5, 3))
    code = oscillator.compiled.rates_tangent
    nothing = np.empty(0, dtype=np.int64)
    for row, value in zip(parameters, affine_population(code, 2, 1, parameters), strict=True):
        np.testing.assert_array_equal(value, affine_matrices(code, 2, 2, 1, nothing, row)[0])


def test_rates_and_jacobian_are_evaluated_row_by_row(oscillator: Model, rng: np.random.Generator) -> None:
    states, inputs = rng.standard_normal((4, 2)), rng.standard_normal((4, 1))
    p = np.tile(oscillator.parameters.values, (4, 1))
    rates, jacobian = np.empty((4, 2)), np.zeros((4, 2, 2 + 1 + 3))
    evaluate_tangent(oscillator.compiled.rates_tangent, states, inputs, p, 1.0, rates, jacobian)
    k, c, b = oscillator.parameters.values
    np.testing.assert_allclose(rates[:, 1], b * inputs[:, 0] - k * states[:, 0] - c * states[:, 1])
    np.testing.assert_allclose(jacobian[:, 1, 3], -states[:, 0])


@dataclass(frozen=True)
class Population:
    """Random stable pairs of two states and one input, discretised with held inputs."""

    a: np.ndarray
    b: np.ndarray
    phi: np.ndarray
    gamma: np.ndarray


@pytest.fixture
def population(rng: np.random.Generator) -> Population:
    a = 0.5 * rng.standard_normal((COUNT, 2, 2)) - np.eye(2)
    b = rng.standard_normal((COUNT, 2, 1))
    phi, gamma = np.empty((COUNT, 2, 2)), np.empty((COUNT, 2, 1))
    discretise(a, b, STEP, phi, gamma)
    return Population(a, b, phi, gamma)


def test_discretisation_is_the_matrix_exponential(population: Population) -> None:
    for k in range(COUNT):
        exact = expm(STEP * np.block([[population.a[k], population.b[k]], [np.zeros((1, 3))]]))
        np.testing.assert_allclose(population.phi[k], exact[:2, :2], rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(population.gamma[k], exact[:2, 2:], rtol=1e-12, atol=1e-14)


def test_the_misfit_is_that_of_the_trajectories(population: Population, rng: np.random.Generator) -> None:
    samples, v, start = 9, rng.standard_normal((8, 1)), rng.standard_normal((COUNT, 2))
    y = np.empty((COUNT, samples, 2))
    trajectories(population.phi, population.gamma, v, 1, start, np.arange(2), y)
    x = start.copy()
    for k in range(samples - 1):
        np.testing.assert_allclose(y[:, k], x, rtol=1e-12)
        x = np.einsum("cij,cj->ci", population.phi, x) + population.gamma[:, :, 0] * v[k]

    measured, weight, cost = rng.standard_normal((samples, 2)), np.array([1.0, 3.0]), np.empty(COUNT)
    measured[4, 1] = np.nan
    misfit(population.phi, population.gamma, v, 1, start, measured, weight, cost)
    np.testing.assert_allclose(cost, np.nansum(weight * (y - measured) ** 2, axis=(1, 2)), rtol=1e-12)


def test_a_candidate_that_is_not_finite_has_an_infinite_misfit(population: Population) -> None:
    start = np.zeros((COUNT, 2))
    start[3] = np.inf
    cost = np.empty(COUNT)
    measured, v = np.zeros((3, 2)), np.zeros((2, 1))
    misfit(population.phi, population.gamma, v, 1, start, measured, np.ones(2), cost)
    assert np.isinf(cost[3]) and np.all(np.delete(cost, 3) == 0.0)


# Propagators and their derivatives against SciPy's matrix exponential of the block matrix (Van Loan 1978).


@pytest.mark.parametrize("size", [0.01, 1.0, 30.0])
def test_values_and_derivatives_equal_the_block_exponential(size: float, rng: np.random.Generator) -> None:
    n, count, h = 4, 3, 0.5
    a, da = size * rng.normal(size=(n, n)), rng.normal(size=(count, n, n))
    value, slope = propagators(a, da, h)
    block, zero = np.zeros((3 * n, 3 * n)), np.zeros((3 * n, 3 * n))
    block[:n, :n], block[:n, n : 2 * n], block[n : 2 * n, 2 * n :] = a, np.eye(n), np.eye(n)
    whole = expm(block * h)
    for m, (expected, unit) in enumerate([(whole[:n, :n], 1.0), (whole[:n, n : 2 * n], 1.0), (whole[:n, 2 * n :], h)]):
        np.testing.assert_allclose(value[m], expected / unit, atol=1e-12 * np.abs(expected).max() / unit)
    for q in range(count):
        zero[:n, :n] = da[q]
        derivative = expm_frechet(block * h, zero * h)[1][:n]
        for m, unit in enumerate([1.0, 1.0, h]):
            expected = derivative[:, m * n : (m + 1) * n] / unit
            np.testing.assert_allclose(slope[q, m], expected, atol=2e-12 * np.abs(expected).max())


def test_a_matrix_beyond_all_scaling_gives_nan() -> None:
    value, _ = propagators(np.full((2, 2), 1e30), np.zeros((0, 2, 2)), 1.0)
    assert np.isnan(value).all()
