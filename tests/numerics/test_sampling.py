"""Draws from densities whose moments are known: a Gaussian, a bent one, one with a bound."""

import numpy as np
import pytest

from seatrial.numerics.sampling import ChainSettings, effective_sizes, sample_chains, split_r_hat

COVARIANCE = np.array([[1.0, 0.9, 0.0], [0.9, 2.0, -0.5], [0.0, -0.5, 4e-4 + 0.25]])
CENTRE = np.array([3.0, -1.0, 0.2])


def gaussian(points: np.ndarray) -> np.ndarray:
    off = points - CENTRE
    return -0.5 * np.einsum("mi,ij,mj->m", off, np.linalg.inv(COVARIANCE), off)


def test_a_gaussian_comes_back_within_monte_carlo_error() -> None:
    chains = sample_chains(gaussian, CENTRE + 0.1, 1.3 * COVARIANCE, seed=4)
    draws = chains.points.reshape(-1, 3)
    assert chains.is_converged
    assert np.max(chains.r_hat) <= 1.01
    error = np.sqrt(np.diag(COVARIANCE) / chains.effective_size)
    np.testing.assert_array_less(np.abs(draws.mean(axis=0) - CENTRE), 4.0 * error)
    spread = np.cov(draws, rowvar=False)
    share = 4.0 * np.sqrt(2.0 / np.min(chains.effective_size))  # of a variance: the error of chi squared
    np.testing.assert_allclose(np.diag(spread), np.diag(COVARIANCE), rtol=share)
    np.testing.assert_allclose(chains.log_density, gaussian(chains.points.reshape(-1, 3)).reshape(4, -1))


def test_a_bent_density_is_followed() -> None:
    """x normal, y = x^2 + normal / 10: mean of y 1, variance 2.01, where the Gaussian about the mode has 0.01."""

    def bent(points: np.ndarray) -> np.ndarray:
        x, y = points.T
        return -0.5 * (x**2 + 100.0 * (y - x**2) ** 2)

    settings = ChainSettings(r_hat=1.05, most_steps=6000)
    chains = sample_chains(bent, np.zeros(2), np.diag([1.0, 0.3]), seed=1, settings=settings)
    draws, error = chains.points.reshape(-1, 2), 4.0 / np.sqrt(np.min(chains.effective_size))
    assert draws[:, 1].mean() == pytest.approx(1.0, abs=error * np.sqrt(2.01))
    assert draws[:, 0].mean() == pytest.approx(0.0, abs=error)


def test_nothing_is_drawn_where_the_density_is_zero() -> None:
    def half(points: np.ndarray) -> np.ndarray:
        return np.where(points[:, 0] >= 0.0, -0.5 * points[:, 0] ** 2, -np.inf)

    draws = sample_chains(half, np.array([0.0]), np.array([[1.0]]), seed=2).points
    assert draws[:, 10:].min() >= 0.0
    assert draws.mean() == pytest.approx(np.sqrt(2.0 / np.pi), abs=0.15)


def test_the_same_seed_draws_the_same_bits() -> None:
    first, again, other = (sample_chains(gaussian, CENTRE, COVARIANCE, seed=s).points for s in (7, 7, 8))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first[:, :10], other[:, :10])


def test_chains_that_a_user_ends_keep_what_they_have() -> None:
    calls = 0

    def interrupted(points: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        if calls > 130:
            raise KeyboardInterrupt
        return gaussian(points)

    chains = sample_chains(interrupted, CENTRE, COVARIANCE, seed=0, settings=ChainSettings(effective_size=1e6))
    assert chains.is_interrupted
    assert not chains.is_converged
    assert chains.points.shape == (4, 50, 3)
    with pytest.raises(KeyboardInterrupt):
        calls = 100
        sample_chains(interrupted, CENTRE, COVARIANCE, seed=0)


def test_chains_that_disagree_are_distinguished_from_chains_that_agree() -> None:
    rng = np.random.default_rng(0)
    agree = rng.standard_normal((4, 400, 1))
    apart = agree + np.array([0.0, 0.0, 0.0, 3.0])[:, None, None]
    assert split_r_hat(agree)[0] == pytest.approx(1.0, abs=0.01)
    assert split_r_hat(apart)[0] > 1.3
    assert np.isinf(split_r_hat(np.ones((4, 10, 1)))[0])


def test_correlated_draws_are_worth_fewer() -> None:
    """An autoregression of 0.8 has an autocorrelation time of 9 draws."""
    rng = np.random.default_rng(3)
    values = np.zeros((4, 5000, 1))
    for t in range(1, 5000):
        values[:, t] = 0.8 * values[:, t - 1] + rng.standard_normal((4, 1))
    assert 20000 / effective_sizes(values)[0] == pytest.approx(9.0, rel=0.15)
