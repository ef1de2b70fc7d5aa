"""How far another estimator's coefficients are from the truth, or from the fit."""

from seatrial.core.results import Baseline, IntervalEstimate, OpenLoopScores


def test_without_a_truth_the_fit_is_the_reference() -> None:
    fit, other = Baseline("fit", {"a": 2.0, "b": 0.0}), Baseline("svr", {"a": 3.0, "b": 1.0})
    assert other.relative_deviation(fit) == {"a": 0.5}


def test_with_a_truth_the_errors_are_given() -> None:
    fit = Baseline("fit", {"a": 2.0}, error={"a": 0.1})
    assert Baseline("svr", {"a": 3.0}, error={"a": 0.4}).relative_deviation(fit) == {"a": 0.4}


def test_runs_that_diverge_are_counted_over_both_roles() -> None:
    scores = OpenLoopScores(diverged=("one",)), OpenLoopScores(diverged=("two",))
    assert Baseline("svr", training=scores[0], validation=scores[1]).diverged == ("one", "two")


def test_an_interval_is_scaled_with_its_value() -> None:
    assert IntervalEstimate(2.0, 1.0, 4.0).scaled(3.0) == IntervalEstimate(6.0, 3.0, 12.0)
