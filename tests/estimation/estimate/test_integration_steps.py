"""Coefficients from logs with few samples a period, of craft simulated by their own equations in fine steps."""

import numpy as np
import pytest
from benchmarks.sample_rates import CRAFTS, NOMOTO, estimated, nomoto_runs, standardised

from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate import Runs, estimate_model
from seatrial.estimation.estimate.point_estimate import filter_with_steps, sufficient_steps_of_filter
from seatrial.physics.models import model_named


@pytest.mark.parametrize(("name", "rate", "steps"), [
    ("roll decay, 5 s", 1.0, 8), ("roll decay, 5 s", 10.0, 1), ("boat with a rudder, 0.9 s", 1.0, 8),
])  # fmt: skip
def test_intervals_hold_the_truth_at_any_rate(name: str, rate: float, steps: int) -> None:
    """One step a sample gives the roll at 1 Hz a negative damping, 92 standard errors off."""
    craft = CRAFTS[name]
    estimation = estimated(craft, rate, seed=0)
    assert estimation.estimate.problem.substeps == steps
    assert any("Runge-Kutta steps" in reason for reason in estimation.reasons) == (steps > 1)
    assert np.all(np.abs(standardised(craft, estimation)) < 1.5), "half widths of 95 % intervals"


def test_steps_are_judged_by_the_filter_that_the_estimate_is_from() -> None:
    """One step a sample moves the coefficients of a boat that turns in 0.9 s, logged at 1 Hz."""
    records = nomoto_runs(1.0, np.random.default_rng(5))
    model = model_named("nomoto")
    model = model.with_parameters(model.parameters.only_free(NOMOTO))
    settings = EstimateSettings(method=EstimateMethod.PREDICTION_ERROR).with_known_timing(["delta"])
    estimation = estimate_model(model, Runs.one_session_each(records, 2.0), settings)
    noise = estimation.process_noise
    assert noise is not None and noise.problem.runs.substeps > 1
    assert sufficient_steps_of_filter(noise.problem, noise.optimum) == noise.problem.runs.substeps
    coarse = filter_with_steps(noise.problem, 1)
    assert sufficient_steps_of_filter(coarse, noise.optimum) > 1
    error = estimation.estimate.common_parameters[:3] - np.array([NOMOTO[n] for n in estimation.estimate.problem.free])
    assert np.all(np.abs(error) < 1.5 * estimation.interval.half_width[:3])
