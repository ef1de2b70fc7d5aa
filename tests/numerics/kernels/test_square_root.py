"""Belief as a square root against covariances and information written with numpy here."""

import numpy as np
import pytest

from seatrial.numerics.kernels.recursive import forget, project_root, update_sample, update_scalar

Array = np.ndarray
N = 5


@pytest.fixture
def root(rng: np.random.Generator) -> Array:
    return rng.standard_normal((N, N))


def test_a_measurement_adds_its_information(root: Array, rng: np.random.Generator) -> None:
    z, h, v, e = rng.standard_normal(N), rng.standard_normal(N), np.empty(N), 0.7
    before, P = z.copy(), root @ root.T
    update_scalar(root, z, v, project_root(root, h, v), 0.3, e)
    after = np.linalg.inv(np.linalg.inv(P) + np.outer(h, h) / 0.3)
    np.testing.assert_allclose(root @ root.T, after, rtol=1e-9)
    np.testing.assert_allclose(z - before, after @ h * e / 0.3, rtol=1e-9)


def test_no_variance_at_all_does_no_harm(root: Array) -> None:
    root[2] = 0.0
    h, v, z = np.eye(N)[2], np.empty(N), np.zeros(N)
    update_scalar(root, z, v, project_root(root, h, v), 1e-300, 1.0)
    assert np.all(np.isfinite(root))
    assert not np.any(root[2])
    assert not np.any(z)


def test_forgetting_mixes_the_information_and_leaves_the_mean(root: Array, rng: np.random.Generator) -> None:
    z, widest = rng.standard_normal(N), rng.standard_normal((3, N))
    before, information = z.copy(), np.linalg.inv(root @ root.T)
    forget(root, z, widest, 0.9, np.empty(N))
    np.testing.assert_allclose(np.linalg.inv(root @ root.T), 0.9 * information + 0.1 * widest.T @ widest, rtol=1e-8)
    np.testing.assert_array_equal(z, before)


def test_forgetting_ends_at_the_wide_belief() -> None:
    root, widest = 1e-3 * np.eye(2), np.diag([0.5, 0.1])
    for _ in range(400):
        forget(root, np.zeros(2), widest, 0.9, np.empty(2))
    np.testing.assert_allclose(root @ root.T, np.diag([4.0, 100.0]), rtol=1e-9)


def taken(root: Array, measured: Array, limit: float = 6.0) -> tuple[Array, Array, Array]:
    """z, running and tally after one sample of two channels predicted as 0, variances 1."""
    z, h, running, tally = np.zeros(N), np.eye(2, N), np.zeros((2, 2)), np.zeros((2, 2), dtype=np.int64)
    update_sample(root, z, z.copy(), h, np.zeros(2), measured, np.ones(2), limit, 100.0, running, tally, np.empty(N))
    return z, running, tally


def test_channels_come_one_after_the_other_as_if_at_once(root: Array) -> None:
    P, measured, h = root @ root.T, np.array([0.3, -1.1]), np.eye(2, N)
    z, _, tally = taken(root, measured)
    np.testing.assert_allclose(z, P @ h.T @ np.linalg.solve(h @ P @ h.T + np.eye(2), measured), rtol=1e-9)
    np.testing.assert_array_equal(tally, [[1, 1], [0, 0]])


def test_what_is_missing_changes_nothing(root: Array) -> None:
    before = root.copy()
    z, running, tally = taken(root, np.array([np.nan, np.nan]))
    np.testing.assert_array_equal(root, before)
    assert not np.any(z) and not np.any(running) and not np.any(tally)


def test_an_outlier_is_counted_and_its_pull_is_bounded(root: Array) -> None:
    P = root @ root.T
    far, running, tally = taken(root.copy(), np.array([1e6, np.nan]))
    near = taken(root.copy(), np.array([6.0 * np.sqrt(1.0 + P[0, 0]), np.nan]))[0]
    assert tally[1, 0] == 1
    assert running[0, 0] == pytest.approx(36.0)
    mahalanobis = np.sqrt(far @ np.linalg.solve(P, far))
    assert mahalanobis <= 6.0
    assert np.sqrt(near @ np.linalg.solve(P, near)) <= 6.0
