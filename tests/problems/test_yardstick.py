"""Errors in the unit that a problem states."""

import numpy as np
import pytest

from seatrial.problems import KnownOptimum, KnownTruth


def test_errors_over_the_bound() -> None:
    stick = KnownTruth(np.array([1.0, -2.0]), np.array([0.1, 0.2]))
    assert stick.error(np.array([1.1, -2.4])) == pytest.approx(np.sqrt((1.0 + 4.0) / 2.0))
    assert stick.success_limit == 2.0


def test_errors_without_noise_are_in_per_cent() -> None:
    assert KnownTruth(np.array([1.0, -2.0])).error(np.array([1.02, -2.04])) == pytest.approx(2.0)


def test_errors_of_gains_are_excess_of_the_objective() -> None:
    stick = KnownOptimum(lambda points: 2.0 + np.sum(points**2, axis=1), 2.0)
    assert stick.error(np.array([0.0, 0.1])) == pytest.approx(0.5)
    assert KnownOptimum(lambda points: np.full(len(points), np.inf), 2.0).error(np.zeros(2)) == np.inf
