"""Ticks are round numbers within the range; ranges enclose what is finite; curves of fewer points keep what matters."""

import numpy as np
import pytest

from seatrial.core.figures.ticks import decade_ticks, decimated, linear_ticks, span, thinned, whole_decades


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-37.0, 41.0), (0.66, 1.21), (-3e-4, 2e-4), (0.0, 2075.0)])
@pytest.mark.parametrize("count", [2, 4, 8])
def test_linear_ticks_are_equidistant_within_the_range_and_about_as_many(low: float, high: float, count: int) -> None:
    values = [tick.value for tick in linear_ticks(low, high, count)]
    assert all(low - 1e-9 <= v <= high + 1e-9 for v in values)
    assert max(2, count / 2) <= len(values) <= 2 * count
    assert np.ptp(np.diff(values)) < 1e-9 * (high - low)


def test_a_tick_has_a_true_minus_and_rounding_is_zero() -> None:
    assert [tick.text for tick in linear_ticks(-0.3, 0.3, 7)] == ["−0.3", "−0.2", "−0.1", "0", "0.1", "0.2", "0.3"]
    assert [tick.text for tick in linear_ticks(2.0, 2.0, 4)] == ["2"]


def test_decades_have_steps_between_them_where_they_are_few_and_are_skipped_where_many() -> None:
    assert [t.text for t in decade_ticks(0.01, 30.0, 4)] == ["0.01", "0.1", "1", "10"]
    assert [t.text for t in decade_ticks(1.0, 30.0, 5)] == ["1", "2", "5", "10", "20"]
    assert len(decade_ticks(1e-12, 1e12, 5)) <= 10


def test_constant_and_empty_values_have_a_range() -> None:
    for values in (np.full(9, 3.0), np.zeros(9), np.full(9, np.nan)):
        low, high = span([values])
        assert high > low
    assert span([np.array([0.0, np.nan, 10.0])], 0.1) == (-1.0, 11.0)


def test_whole_decades_enclose_values_and_the_least_range() -> None:
    assert whole_decades([0.3, 70.0], (1.0, 10.0)) == pytest.approx((0.1, 100.0))
    assert whole_decades([], (1.0, 1000.0)) == pytest.approx((1.0, 1000.0))


def test_decimation_keeps_extremes_order_and_gaps(rng: np.random.Generator) -> None:
    x = np.arange(10_000.0)
    y = rng.standard_normal(10_000)
    y[5_000:6_000] = np.nan
    a, b = decimated(x, y, 400)
    assert len(a) <= 400 and np.all(np.diff(a) >= 0)
    assert np.nanmax(b) == np.nanmax(y) and np.nanmin(b) == np.nanmin(y)
    assert np.isnan(b[(a > 5_050) & (a < 5_950)]).all()


def test_thinning_keeps_both_ends_and_short_curves_whole() -> None:
    x = np.arange(1_000.0)
    a, b = thinned(x, 2.0 * x, 50)
    assert len(a) == 50 and (a[0], a[-1]) == (0.0, 999.0) and np.array_equal(b, 2.0 * a)
    assert len(thinned(x[:9], x[:9], 50)[0]) == 9
