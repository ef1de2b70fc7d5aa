"""Eight repeats of the Monte-Carlo benchmark on a short series: near the Cramer-Rao bound, intervals that cover.

Limits are the 0.1 % quantiles of eight Gaussian errors; the benchmark holds two hundred to narrow ones.
"""

import montecarlo
import numpy as np
import pytest
from scipy import stats

RUNS = 8


@pytest.mark.long
def test_errors_keep_to_the_bound() -> None:
    made = montecarlo.series(runs=RUNS, seed=1, executes=1)
    low, high = np.sqrt(stats.chi2.ppf([0.001, 0.999], RUNS) / RUNS)
    assert made.converged == RUNS
    assert made.white == RUNS
    assert np.all(made.ratio > low), made.ratio
    assert np.all(made.ratio < high), made.ratio
    assert 0.75 < np.median(made.ratio) < 1.3
    assert np.mean(made.coverage) >= 0.88
    widths = np.mean(made.half_widths, axis=0) / made.bound
    np.testing.assert_allclose(widths, stats.norm.ppf(0.975), rtol=0.25)


def test_the_table_can_fail() -> None:
    """Errors twice the bound under intervals of one bound."""
    bound, draws = np.full(3, 0.1), np.random.default_rng(3).standard_normal((50, 3))
    wrong = montecarlo.Series(("a", "b", "c"), np.ones(3), bound, 0.2 * draws, np.full((50, 3), 0.1), 49, 50, 1.0)
    held = {line.quantity.split(" (")[0]: line.holds for line in montecarlo.lines(wrong)}
    assert held["runs converged"] is False
    assert held["a: RMSE / bound"] is False
    assert held["b: coverage"] is False
    assert held["coverage of 95 % intervals, pooled"] is False
