"""A sample of the benchmark on gusts: gusts with a memory and a controller leave estimates and intervals honest."""

import gusts
import numpy as np
import pytest


@pytest.mark.parametrize(
    ("is_closed", "runs"), [(True, 1), *(pytest.param(is_closed, 2, marks=pytest.mark.long) for is_closed in (0, 1))]
)
def test_a_gust_with_a_memory_is_modelled(is_closed: bool, runs: int) -> None:
    """Yaw disturbance worth 2 deg of rudder with a memory of 5 s; of the runs each lies within 3.5 errors."""
    cell = gusts.Cell("nomoto", gusts.Disturbance(0.5, 5.0), bool(is_closed))
    results = gusts.outcomes(cell, "independent", runs, gusts.SEED, 1)
    assert [o.failure for o in results] == [""] * runs
    assert [o.disturbance for o in results] == ["first-order Markov on r"] * runs
    for o in results:
        assert np.all(np.abs(o.error) < 3.5 * o.standard_error), o
        assert np.all(np.abs(np.log(o.standard_error / o.bound)) < 0.6), o


@pytest.mark.long
def test_a_closed_loop_is_fitted_by_prediction_error_though_nothing_disturbs_it() -> None:
    cell = gusts.Cell("nomoto", gusts.Disturbance(0.0, 0.0), is_closed=True)
    (result,) = gusts.outcomes(cell, "independent", 1, gusts.SEED, 1)
    assert result.disturbance == "white"
    assert np.all(np.abs(result.error) < 3.5 * result.standard_error)
    assert np.all(np.abs(np.log(result.standard_error / result.bound)) < 0.3)


def test_the_score_can_fail() -> None:
    one = np.ones(2)
    biased = [gusts.Outcome(3.0 * one, one, one, 0.0 * one, one > 1.0, "white", True, 0.1)] * 10
    assert gusts.score(biased).problems(0.86, 0.35) == "coverage < 86%; bias > 0.35; RMSE/bound > 1.2"
