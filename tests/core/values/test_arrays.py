"""Arrays that nobody can change, correlations, and values that stand for no reading."""

import numpy as np
import pytest

from seatrial.core.values import frozen
from seatrial.core.values.arrays import correlation_matrix, mask_intervals, sentinel_value, smeared_wraps


def test_correlation_of_a_covariance() -> None:
    assert np.allclose(correlation_matrix(np.array([[4.0, -1.0], [-1.0, 1.0]])), [[1.0, -0.5], [-0.5, 1.0]])
    assert np.isnan(correlation_matrix(np.diag([1.0, 0.0]))[1]).all()


def test_a_frozen_array_is_a_copy_that_cannot_be_written() -> None:
    source = np.zeros(3)
    copy = frozen(source)
    source[0] = 1.0
    assert copy[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        copy[1] = 2.0


def test_only_what_recurs_far_outside_is_no_reading() -> None:
    values = np.linspace(-1.0, 1.0, 50)
    assert sentinel_value(np.append(values, [-999.0, -999.0])) == -999.0
    assert sentinel_value(np.append(values, [1e6, np.nan, 1e6])) == 1e6
    assert sentinel_value(np.append(values, -999.0)) is None and sentinel_value(values) is None


def test_north_is_next_to_a_heading_a_little_west_of_it() -> None:
    headings = np.radians(np.append(np.linspace(355.0, 359.9, 50), [0.0, 0.0, 0.0]))
    assert sentinel_value(headings, "rad") is None and sentinel_value(headings) == 0.0
    assert sentinel_value(np.append(headings[:50], np.radians([-999.0, -999.0])), "rad") == np.radians(-999.0)
    assert sentinel_value(np.append(headings[:50], [2.0, 2.0]), "rad") == 2.0


def test_a_circle_in_a_long_log_is_no_averaged_heading() -> None:
    rate = np.zeros(20_000)
    rate[4000:4200] = np.radians(3.0)
    assert smeared_wraps(np.mod(np.cumsum(rate), 2.0 * np.pi)) == []


def test_a_short_run_that_is_all_circle_is_searched_within_its_turn_only() -> None:
    unwrapped = np.radians(np.append(np.full(20, 182.0), 182.0 - 3.0 * np.arange(111)))
    assert smeared_wraps(unwrapped) == []
    assert smeared_wraps(np.mod(unwrapped, 2.0 * np.pi)) == []


def test_a_heading_interpolated_as_a_number_runs_the_wrong_way_round() -> None:
    time = np.arange(0.0, 100.0, 0.1)
    second = np.mod(np.radians(25.0 * np.sin(time[::10] / 15.0)), 2.0 * np.pi)
    smeared = smeared_wraps(np.interp(time, time[::10], second))
    assert len(smeared) == np.count_nonzero(np.abs(np.diff(second)) > np.pi)
    assert max(b - a for a, b in smeared) <= 30


def test_stretches_of_a_mask_are_in_order() -> None:
    assert mask_intervals(np.array([True, False, True, True])) == [(0, 1), (2, 4)]
    assert mask_intervals(np.zeros(2, bool)) == []
