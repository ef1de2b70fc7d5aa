"""Information carried on: least squares in parts gives what all at once gives, priors counted once."""

import numpy as np
import pytest

from seatrial.estimation.estimate.assemble import marginalise

PLACES = np.array([0, 1])


def _solved(hessian, gradient, known, weight, mean):
    """Minimiser of one part's squares, what is carried and the priors."""
    free = (0, 1)
    marginal = known.normal(np.zeros(2), free)
    h = hessian + np.diag(weight) + marginal.hessian
    g = gradient - weight * mean + marginal.gradient
    return np.linalg.solve(h, -g), h


@pytest.mark.parametrize("weight", [np.zeros(2), np.array([3.0, 0.5])])
def test_in_parts_is_all_at_once(weight):
    rng = np.random.default_rng(1)
    mean, known = np.array([1.0, -2.0]), marginalise(PLACES, np.zeros(2), np.zeros((2, 2)), np.zeros(2), np.zeros(2))
    point = mean
    total, pull = np.zeros((2, 2)), np.zeros(2)
    for _ in range(5):
        rows, seen = rng.standard_normal((6, 2)), rng.standard_normal(6)
        hessian, gradient = rows.T @ rows, -rows.T @ seen
        total, pull = total + hessian, pull + gradient
        point, sum_of_all = _solved(hessian, gradient, known, weight, mean)
        known = marginalise(PLACES, point, sum_of_all, mean, weight)
    expected = np.linalg.solve(total + np.diag(weight), weight * mean - pull)
    np.testing.assert_allclose(point, expected, rtol=1e-9)
    np.testing.assert_allclose(known.information, total, rtol=1e-9)


def test_a_prior_does_not_pull_again_at_each_stretch_that_tells_nothing():
    weight, mean = np.array([4.0, 0.0]), np.zeros(2)
    marginal, seen = np.diag([4.0, 1.0]), np.array([1.0, 1.0])
    nothing = marginalise(PLACES, mean, np.zeros((2, 2)), mean, mean)
    point, hessian = _solved(marginal, -marginal @ seen, nothing, weight, mean)
    assert point[0] == pytest.approx(0.5)
    for _ in range(20):
        known = marginalise(PLACES, point, hessian, mean, weight)
        point, hessian = _solved(np.zeros((2, 2)), np.zeros(2), known, weight, mean)
    np.testing.assert_allclose(point, [0.5, 1.0], rtol=1e-9)


def test_nuisances_are_eliminated_not_forgotten():
    """A coefficient that only the sum with a nuisance is known of is no better known than the nuisance's prior."""
    hessian = np.array([[1e6, 0.0, 1e6], [0.0, 1.0, 0.0], [1e6, 0.0, 1e6 + 4.0]])
    known = marginalise(PLACES, np.zeros(2), hessian, np.zeros(2), np.zeros(2))
    np.testing.assert_allclose(np.diag(known.information), [4.0, 1.0], rtol=1e-4)


def test_gradient_and_cost_agree():
    known = marginalise(
        PLACES, np.array([1.0, 2.0]), np.array([[3.0, 1.0], [1.0, 2.0]]), np.zeros(2), np.array([0.5, 0.1])
    )
    at, step = np.array([0.3, -0.4]), 1e-6
    slope = [(known.cost(at + step * e) - known.cost(at - step * e)) / (2 * step) for e in np.eye(2)]
    np.testing.assert_allclose(known.normal(at, (0, 1)).gradient, slope, rtol=1e-6)


def test_what_fades_counts_less_and_points_the_same_way():
    known = marginalise(PLACES, np.ones(2), np.eye(2), np.zeros(2), np.zeros(2))
    np.testing.assert_allclose(known.discounted(0.25).information, 0.25 * np.eye(2))
    assert known.discounted(0.25).cost(np.zeros(2)) == pytest.approx(0.25)


def test_coloured_residuals_inflate_the_covariance():
    hessian = np.array([[5.0, 1.0], [1.0, 2.0]])
    known = marginalise(PLACES, np.zeros(2), hessian, np.zeros(2), np.zeros(2))
    assert known.inflation(hessian, 9.0 * np.linalg.inv(hessian)) == pytest.approx(9.0)
    assert known.inflation(hessian, 0.1 * np.linalg.inv(hessian)) == 1.0
