"""Intervals of differences against their definitions and by simulation, and the test of all together."""

import numpy as np
import pytest
from scipy.stats import chi2, norm

from seatrial.estimation.information.covariance import QuantityInterval, differences, joint_test


def quantity(value: float | None, below: float = 0.0, above: float = 0.0) -> QuantityInterval:
    if value is None:
        return QuantityInterval("K", "1/s", None)
    return QuantityInterval("K", "1/s", value, value - below, value + above)


def test_symmetric_intervals_add_in_squares_and_others_side_by_side() -> None:
    (row,) = differences([quantity(1.0, 0.3, 0.3)], [quantity(2.0, 0.4, 0.4)])
    assert (row.difference, row.lower, row.upper) == pytest.approx((1.0, 0.5, 1.5))
    (row,) = differences([quantity(1.0, 0.3, 0.0)], [quantity(2.0, 0.4, 1.2)])
    assert row.lower == pytest.approx(1.0 - np.hypot(0.4, 0.0))
    assert row.upper == pytest.approx(1.0 + np.hypot(1.2, 0.3))


def test_joint_intervals_are_wider_for_more_rows() -> None:
    """A difference of 2.5 standard errors: significant alone, and among twenty not (Bonferroni: 3.02)."""
    half = norm.ppf(0.975)
    pair = quantity(0.0, half, half), quantity(2.5, 0.0, 0.0)
    others = [(quantity(0.0, half, half), quantity(0.0, 0.0, 0.0))] * 19
    assert differences([pair[0]], [pair[1]])[0].is_significant
    joint = differences([pair[0], *(a for a, _ in others)], [pair[1], *(b for _, b in others)])
    assert not joint[0].is_significant
    far = quantity(3.1, 0.0, 0.0)
    assert differences([pair[0], *(a for a, _ in others)], [far, *(b for _, b in others)])[0].is_significant


def test_what_is_not_determined_has_no_interval() -> None:
    known, unknown = quantity(1.0, 0.1, 0.1), QuantityInterval("K", "1/s", 2.0)
    (row,) = differences([known], [unknown])
    assert (row.difference, row.lower, row.is_significant) == (1.0, None, None)
    (row,) = differences([known], [quantity(None)])
    assert row.difference is None


def test_equal_coefficients_are_called_different_in_5_of_100_cases() -> None:
    rng = np.random.default_rng(3)
    root = np.array([[0.2, 0.0, 0.0], [1.0, 0.1, 0.0], [-3.0, 2.0, 4.0]])
    tests = [joint_test(root @ rng.standard_normal(3), root @ root.T) for _ in range(4000)]
    alarms = np.mean([t is not None and t.p < 0.05 for t in tests])
    assert alarms == pytest.approx(0.05, abs=0.012)  # three standard deviations of 4000 trials
    (one,) = [joint_test(np.array([0.2, 1.0, 1.0]), root @ root.T)]
    assert one is not None
    assert one.p == pytest.approx(chi2.sf(one.statistic, 3))


def test_directions_that_nothing_determines_are_left_out() -> None:
    flat = np.array([[1.0, 1.0], [1.0, 1.0]])
    test = joint_test(np.array([1.0, 1.0]), flat)
    assert test is not None
    assert (test.degrees_of_freedom, test.statistic) == (1, pytest.approx(1.0))
    assert joint_test(np.zeros(0), np.zeros((0, 0))) is None
    assert joint_test(np.ones(1), np.array([[np.inf]])) is None
    assert joint_test(np.ones(1), np.zeros((1, 1))) is None


def test_values_that_differ_by_rounding_are_one() -> None:
    """As of a speed that both fits have by definition, whose intervals have no width."""
    (row,) = differences([quantity(6.1)], [quantity(6.1 * (1.0 + 2.2e-16))])
    assert (row.difference, row.is_significant) == (0.0, False)
    (row,) = differences([quantity(6.1)], [quantity(6.1001)])
    assert row.is_significant
