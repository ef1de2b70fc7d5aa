"""Intervals: the information matrix, runs left out, and blocks, against exact results of linear problems."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats
from scipy.signal import lfilter

from seatrial.estimation.information.covariance import (
    Interval,
    RunScores,
    bootstrap,
    excess_spread,
    from_information,
    inverse,
    jackknife,
    sandwich,
    with_prior,
)

Array = NDArray[np.float64]
RUNS, ROWS, UNKNOWNS = 12, 40, 3


@pytest.fixture
def runs(rng: np.random.Generator) -> tuple[Array, Array]:
    """Matrices (runs, rows, unknowns) and right sides of a linear problem."""
    matrices = rng.standard_normal((RUNS, ROWS, UNKNOWNS)) * np.array([1.0, 5.0, 0.01])
    return matrices, matrices @ np.array([1.0, -2.0, 300.0]) + rng.standard_normal((RUNS, ROWS))


def normal_equations(matrices: Array, right: Array, point: Array) -> tuple[Array, Array]:
    gradients = np.einsum("srk,sr->sk", matrices, matrices @ point - right)
    return gradients, np.einsum("sri,srj->sij", matrices, matrices)


def solve(matrices: Array, right: Array) -> Array:
    return np.linalg.lstsq(matrices.reshape(-1, UNKNOWNS), right.ravel())[0]


def test_one_step_is_exact_where_the_problem_is_linear(runs: tuple[Array, Array]) -> None:
    matrices, right = runs
    gradients, hessians = normal_equations(matrices, right, solve(matrices, right))
    refits = np.array([solve(np.delete(matrices, i, 0), np.delete(right, i, 0)) for i in range(RUNS)])
    exact = (RUNS - 1) / RUNS * (refits - refits.mean(axis=0)).T @ (refits - refits.mean(axis=0))
    steps = RunScores.from_normals(hessians.sum(axis=0), gradients, hessians).left_out_steps
    interval = jackknife(steps, "one-step")
    np.testing.assert_allclose(interval.covariance, exact, rtol=1e-8)
    assert interval.degrees_of_freedom == RUNS - 1
    assert interval.half_width[0] == pytest.approx(stats.t.ppf(0.975, RUNS - 1) * np.sqrt(exact[0, 0]))


def test_what_one_run_alone_identifies_gets_the_error_of_the_information_matrix(runs: tuple[Array, Array]) -> None:
    """One run has an unknown to itself, as the only one with astern commands has; the others keep theirs."""
    matrices, right = runs
    matrices[1:, :, 2] = 0.0
    right = right + 300.0 * (matrices[:, :, 2] - runs[0][:, :, 2])
    gradients, hessians = normal_equations(matrices, right, solve(matrices, right))
    gradients[0, 2] += 1e-9  # rounding of a gradient that is zero at the optimum; divided by rounding before
    information = hessians.sum(axis=0)
    interval = RunScores.from_normals(information, gradients, hessians).interval("over runs")
    assert interval.standard_error[2] == pytest.approx(from_information(information).standard_error[2], rel=0.1)
    others = [np.delete(matrices[:, :, :2], i, 0).reshape(-1, 2) for i in range(RUNS)]
    ends = [np.linalg.lstsq(a, np.delete(right, i, 0).ravel())[0] for i, a in enumerate(others[1:], 1)]
    assert np.all(interval.standard_error[:2] < 2.0 * np.std(ends, axis=0) * np.sqrt(RUNS - 1))


def test_spread_over_runs_is_unbiased_where_one_run_holds_most_of_the_information(rng: np.random.Generator) -> None:
    """White noise of unit size, so that the true covariance is H^-1; the jackknife's is far too wide there."""
    matrices = rng.standard_normal((4, ROWS, UNKNOWNS)) * np.array([[5.0], [1.0], [1.0], [1.0]])[:, :, None]
    hessians = np.einsum("sri,srj->sij", matrices, matrices)
    information = hessians.sum(axis=0)
    unbiased, left_out = [], []
    for _ in range(2000):
        right = rng.standard_normal((4, ROWS))
        gradients, _ = normal_equations(matrices, right, solve(matrices, right))
        scores = RunScores.from_normals(information, gradients, hessians)
        unbiased.append(np.diag(scores.interval("").covariance))
        left_out.append(np.diag(jackknife(scores.left_out_steps, "").covariance))
    true = np.diag(np.linalg.inv(information))
    np.testing.assert_allclose(np.mean(unbiased, axis=0) / true, 1.0, atol=0.06)  # 3 standard errors of 2000 draws
    assert np.all(np.mean(left_out, axis=0) > 3.0 * true)


def test_spread_over_runs_of_equal_weight_is_the_jackknifes(runs: tuple[Array, Array]) -> None:
    matrices, right = np.repeat(runs[0][:1], RUNS, axis=0), runs[1]
    gradients, hessians = normal_equations(matrices, right, solve(matrices, right))
    scores = RunScores.from_normals(hessians.sum(axis=0), gradients, hessians)
    by_jackknife = jackknife(scores.left_out_steps, "").covariance
    np.testing.assert_allclose(scores.interval("").covariance, by_jackknife, rtol=1e-9)


def test_information_matrix_of_white_noise(runs: tuple[Array, Array]) -> None:
    matrices, _ = runs
    joint = matrices.reshape(-1, UNKNOWNS)
    interval = from_information(joint.T @ joint)
    np.testing.assert_allclose(interval.covariance, np.linalg.inv(joint.T @ joint), rtol=1e-9)
    assert interval.half_width[1] == pytest.approx(1.959964 * interval.standard_error[1])


def test_sandwich_sees_the_colour_that_the_information_matrix_misses(rng: np.random.Generator) -> None:
    """Slow regressors under first-order autoregressive noise, true spread from many repeats."""
    blocks, rows, phi, repeats = 40, 50, 0.9, 400
    time = np.arange(blocks * rows)
    matrix = np.stack([np.ones(len(time)), np.sin(2 * np.pi * time / 500)], axis=1)
    noise = lfilter([np.sqrt(1 - phi**2)], [1, -phi], rng.standard_normal((repeats, len(time) + 200)))[:, 200:]
    hessian = matrix.T @ matrix
    estimates = noise @ matrix @ np.linalg.inv(hessian)
    true = estimates.std(axis=0)
    errors_stated = []
    for e, estimate in zip(noise, estimates, strict=True):
        left = (matrix @ estimate - e).reshape(blocks, rows)
        gradients = np.einsum("br,brk->bk", left, matrix.reshape(blocks, rows, 2))
        errors_stated.append(sandwich(hessian, gradients).standard_error)
    np.testing.assert_allclose(np.mean(errors_stated, axis=0), true, rtol=0.2)
    assert np.all(from_information(hessian).standard_error < 0.35 * true)


def test_inverse_where_scales_differ_widely(rng: np.random.Generator) -> None:
    matrix = rng.standard_normal((8, 4)) * np.array([1e-9, 1.0, 1e6, 1e3])
    hessian = matrix.T @ matrix
    scale = np.sqrt(np.diag(hessian))
    correlation = hessian / np.outer(scale, scale)
    np.testing.assert_allclose(inverse(hessian) * np.outer(scale, scale), np.linalg.inv(correlation), rtol=1e-9)


def test_a_singular_direction_gets_a_huge_error_not_zero() -> None:
    hessian = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    error = from_information(hessian).standard_error
    assert np.all(error[:2] > 1e5)
    assert error[2] == pytest.approx(1.0)


def test_a_parameter_without_influence_overflows_nothing() -> None:
    error = from_information(np.diag([1.0, 0.0])).standard_error
    assert error[0] == pytest.approx(1.0)
    assert np.isfinite(error[1])
    assert error[1] > 1e40


def test_a_coefficient_held_by_its_prior_keeps_the_priors_error() -> None:
    prior = np.array([1e6, 1e-12])
    hessian = np.diag(prior) + np.diag([1e-6, 1e3])
    silent = Interval(np.zeros((2, 2)), 11, "one-step jackknife over 12 runs")
    assert with_prior(silent, hessian, np.diag(prior)).standard_error[0] == pytest.approx(1e-3, rel=1e-6)
    assert with_prior(silent, hessian, np.diag(prior)).standard_error[1] < 1e-6


def test_the_jackknife_of_a_mean_is_its_variance(rng: np.random.Generator) -> None:
    values = rng.standard_normal((15, 2)) * [1.0, 30.0]
    without = np.array([np.delete(values, k, 0).mean(axis=0) for k in range(15)])
    np.testing.assert_allclose(jackknife(without, "").covariance, np.cov(values.T) / 15, rtol=1e-9)


def test_the_bootstrap_of_a_mean_is_its_variance(rng: np.random.Generator) -> None:
    values = rng.standard_normal((8, 1))
    drawn = values[rng.integers(0, 8, (20000, 8))].mean(axis=1)
    interval = bootstrap(drawn, 8, "")
    np.testing.assert_allclose(interval.covariance, np.atleast_2d(np.cov(values.T)) / 8, rtol=0.04)
    assert interval.degrees_of_freedom == 7


def test_the_spread_beyond_errors_is_that_of_known_numbers() -> None:
    """Values 1, 3 and 5 with errors of 1: variance 4, of which 1 is their error's."""
    chance, spread = excess_spread(np.array([1.0, 3.0, 5.0, np.nan]), np.array([1.0, 1.0, 1.0, 1.0]))
    assert spread == pytest.approx(np.sqrt(3.0))
    assert chance == pytest.approx(np.exp(-4.0))
