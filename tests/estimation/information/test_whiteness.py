"""Tests of whiteness: how often they fail white noise, and that they see correlation of either kind."""

import numpy as np
import pytest

from seatrial.estimation.information.whiteness import FALSE_ALARMS, whiteness_test

RUNS, ROWS = 400, 2000


def test_white_noise_fails_as_often_as_stated() -> None:
    """False alarms in either of two channels: at most the stated 2 %, within three standard errors of 400 runs."""
    rng = np.random.default_rng(1)
    failed = sum(not whiteness_test([rng.standard_normal((ROWS, 2))]).is_white for _ in range(RUNS))
    assert failed / RUNS <= FALSE_ALARMS + 3.0 * np.sqrt(FALSE_ALARMS / RUNS)


@pytest.mark.parametrize(("lag", "share"), [(1, 0.2), (60, 0.3)])
def test_short_and_long_correlation_are_seen(lag: int, share: float) -> None:
    noise = np.random.default_rng(2).standard_normal((ROWS, 2))
    noise[lag:, 1] += share * noise[:-lag, 1].copy()
    test = whiteness_test([noise])
    assert not test.is_white
    assert test.p_values[0] > test.level > test.p_values[1]
    assert test.smallest == pytest.approx(2.0 * test.p_values[1])


def test_missing_samples_count_as_none() -> None:
    noise = np.random.default_rng(3).standard_normal((ROWS, 1))
    noise[::3] = np.nan
    assert whiteness_test([noise[:900], noise[900:]]).is_white
