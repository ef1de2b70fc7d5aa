"""Which coefficients a log moves: all differences are tested together, with the correlation of their errors."""

import numpy as np

from seatrial.control.verification.verify import moved_places

COVARIANCE = np.array([[1.0, 0.8], [0.8, 1.0]])


def test_what_chance_explains_is_not_moved() -> None:
    assert moved_places(np.array([1.9, 1.5]), COVARIANCE) == []
    assert moved_places(np.empty(0), np.empty((0, 0))) == []


def test_a_change_against_the_correlation_is_seen_and_put_on_one() -> None:
    """Two standard deviations of the one and none of the other: 11.1 of chi squared, 9.2 are chance."""
    assert moved_places(np.array([2.0, 0.0]), COVARIANCE) == [0]
    assert moved_places(np.array([0.2, -2.0]), COVARIANCE) == [1]


def test_what_one_does_not_explain_is_put_on_both() -> None:
    assert sorted(moved_places(np.array([6.0, -5.0]), COVARIANCE)) == [0, 1]
