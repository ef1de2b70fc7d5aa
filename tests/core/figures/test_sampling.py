"""Curves keep what matters when they have fewer points."""

import numpy as np

from seatrial.core.figures.ticks import decimated, thinned


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
