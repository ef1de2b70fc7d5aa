"""Belief as a square root against covariances and information written with numpy here."""

import numpy as np
import pytest

from seatrial.numerics.kernels.recursive import (
    forget,
    jump_evidence,
    project_root,
    resembling,
    update_jumps,
    update_sample,
    update_scalar,
)

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
    update_sample(root, z, z.copy(), h, np.zeros(2), measured, np.ones(2), limit, 100.0, running, tally, np.empty(N),
                  np.empty((N, 0)), np.empty((2, 2, 0)), np.empty((2, 0)), np.empty(0), np.zeros((2, 4)))  # fmt: skip
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


def test_the_score_of_a_jump_is_that_of_the_innovations_it_would_leave(root: Array, rng: np.random.Generator) -> None:
    """z is measured 30 times; a jump of z[:2] before the first is estimated as from all innovations at once."""
    jump, truth, z, effects = np.array([0.8, -0.5]), rng.standard_normal(N), np.zeros(N), np.zeros((N, 2))
    effects[:2], information, score = np.eye(2), np.zeros((2, 2, 1)), np.zeros((2, 1))
    P, rows = root @ root.T, rng.standard_normal((30, N))
    z[:] = truth + root @ rng.standard_normal(N)
    first, moved = z.copy(), truth + np.concatenate([jump, np.zeros(N - 2)])
    measured = rows @ moved + 0.3 * rng.standard_normal(30)
    for h, y in zip(rows, measured, strict=True):
        v = np.empty(N)
        total = project_root(root, h, v) + 0.09
        update_jumps(root, h, v, total, y - h @ z, 1.0, effects, information, score, np.empty(2))
        update_scalar(root, z, v, total - 0.09, 0.09, y - h @ z)
    covariance = rows @ P @ rows.T + 0.09 * np.eye(30)
    slopes = np.linalg.solve(covariance, rows[:, :2])
    np.testing.assert_allclose(information[:, :, 0], np.tril(rows[:, :2].T @ slopes), rtol=1e-8)
    np.testing.assert_allclose(score[:, 0], slopes.T @ (measured - rows @ first), rtol=1e-7, atol=1e-7)


def _set_evidence(J: Array, d: Array, variance: float, evidence: Array) -> None:
    """By instants first, J (m, k, k) and d (m, k)."""
    information, score = np.ascontiguousarray(np.moveaxis(J, 0, 2)), np.ascontiguousarray(d.T)
    jump_evidence(information, score, variance, np.empty_like(information), np.empty_like(score), evidence)


def test_evidence_is_a_mixture_of_all_coefficients_and_of_each_alone(rng: np.random.Generator) -> None:
    k, variance, slopes = 3, 0.0625, rng.standard_normal((4, 9, 3))
    J, d, evidence = np.einsum("mij,mik->mjk", slopes, slopes), 9.0 * rng.standard_normal((4, k)), np.empty(4)
    _set_evidence(J, d, variance, evidence)
    for m in range(4):
        own = J[m] + np.eye(k) / variance
        of_all = 0.5 * d[m] @ np.linalg.solve(own, d[m]) - 0.5 * np.linalg.slogdet(variance * own)[1]
        alone = 1.0 + variance * np.diagonal(J[m])
        of_each = 0.5 * variance * d[m] ** 2 / alone - 0.5 * np.log(alone)
        assert evidence[m] == pytest.approx(np.log(0.5 * np.exp(of_all) + 0.5 * np.mean(np.exp(of_each))), rel=1e-10)
    _set_evidence(-1e6 * np.eye(k)[None], d[:1], variance, evidence[:1])
    assert evidence[0] == -np.inf


def test_an_innovation_resembles_those_within_a_distance_and_joins_them() -> None:
    latest = np.array([0.0, 5.0, 5.5, -3.0])
    assert resembling(latest, 6.0, 1.0) == 2
    np.testing.assert_array_equal(latest, [6.0, 0.0, 5.0, 5.5])
