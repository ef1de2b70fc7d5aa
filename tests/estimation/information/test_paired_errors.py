"""Two candidates on the same parts: a mean excess counts only beyond what matters and what their scatter explains."""

import numpy as np
import pytest
from scipy import stats

from seatrial.estimation.information.whiteness import is_no_worse, standard_error


def test_standard_error_is_that_of_the_mean(rng: np.random.Generator) -> None:
    excess = rng.standard_normal(9)
    assert standard_error(excess) == pytest.approx(stats.sem(excess))
    assert np.isinf(standard_error(excess[:1]))


def test_it_is_the_one_sided_paired_t_test(rng: np.random.Generator) -> None:
    for shift in np.linspace(-1.0, 2.0, 31):
        excess = shift + rng.standard_normal(4)
        is_worse = stats.ttest_1samp(excess, 0.0, alternative="greater").pvalue < 0.05
        assert is_no_worse(excess, 0.0) == (not is_worse)


def test_what_is_negligible_is_no_worse_however_regular() -> None:
    assert is_no_worse(np.full(4, 0.2), 0.3)
    assert not is_no_worse(np.full(4, 0.4), 0.3)
    assert not is_no_worse(np.array([0.0, 0.0, np.inf, 0.0]), 0.3)
