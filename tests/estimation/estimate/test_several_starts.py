"""Searches from several points: an optimum that the first start misses is found, and every attempt is reported."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import EstimateSettings, FitCriterion
from seatrial.estimation.estimate import EstimatorOptions, Runs, begin_estimate, estimate_model
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.start import find_start, number_of_starts, search_from_several
from seatrial.physics.models import model_named
from seatrial.physics.sensors import Sensors, with_sensors
from seatrial.physics.simulate.replay import replay

TRUTH = {"K": 0.2, "T": 5.0}


@pytest.fixture(scope="module")
def run() -> Record:
    """A zigzag-like run of a first-order ship, with white noise."""
    model = model_named("nomoto").with_values({**TRUTH, "U": 1.0})
    time = np.arange(0.0, 80.0, 0.5)
    planned = Record.from_arrays("run", time, {"delta": 0.3 * np.sign(np.sin(0.2 * time))})
    made = replay(model, planned, dict.fromkeys(model.states, 0.0))
    rng = np.random.default_rng(3)
    spread = {"r": 0.002, "psi": 0.005}
    noisy = {n: made.channel(n).with_values(made[n] + s * rng.standard_normal(len(time))) for n, s in spread.items()}
    return replace(made, channels={"delta": made.channel("delta")} | noisy)


def test_the_end_with_the_lowest_loss_is_used_and_all_are_reported(run: Record) -> None:
    model = model_named("nomoto").with_values({"U": 0.0})
    runs = Runs.one_session_each([run], 10.0)
    settings = EstimateSettings(method=FitCriterion.OUTPUT_ERROR, delays={"delta": 0.0})
    problem = output_error_problem(model, runs, np.inf, settings)
    start = find_start(problem, runs.records, 10.0)
    # a start from which the yaw rate answers the rudder the other way
    astray = replace(start, common_parameters=np.array([-5.0, 1e-3])[: len(problem.free)], origin="astray")
    several = search_from_several(astray, {}, 4, seed=1)
    losses = [a.loss for a in several.attempts]
    assert losses == sorted(losses)
    assert losses[0] == 0.0
    assert [a.is_used for a in several.attempts] == [True, False, False, False]
    assert {a.origin for a in several.attempts} >= {"astray", "the model's own values", "drawn point 1"}
    found = several.attempts[0].values
    assert found["K"] == pytest.approx(TRUTH["K"], rel=0.02)
    assert found["T"] == pytest.approx(TRUTH["T"], rel=0.05)


def test_the_same_seed_searches_from_the_same_points(run: Record) -> None:
    settings = EstimateSettings(method=FitCriterion.OUTPUT_ERROR, starts=3)
    runs = Runs.one_session_each([run], 10.0)
    first, second = (estimate_model(model_named("nomoto"), runs, settings, EstimatorOptions(seed=5)) for _ in range(2))
    assert first.search_attempts == second.search_attempts
    assert len(first.search_attempts) == 3
    assert first.start_method.startswith("the best of 3 starts: ")


def test_an_estimate_that_is_begun_already_ends_the_same(run: Record) -> None:
    model, runs = model_named("nomoto"), Runs.one_session_each([run], 10.0)
    settings, options = EstimateSettings(), EstimatorOptions()
    begun = begin_estimate(model, runs, settings, options)
    alone, again = (estimate_model(model, runs, settings, options, beginning=b) for b in (None, begun))
    np.testing.assert_array_equal(alone.estimate.common_parameters, again.estimate.common_parameters)
    assert again.shooting is begun.shooting and alone.reasons == again.reasons


def test_a_search_with_other_instruments_begins_where_the_one_before_ended(run: Record) -> None:
    """Coefficients that the other has begin at its end, those of instruments at their own values."""
    runs, options = Runs.one_session_each([run], 10.0), EstimatorOptions()
    settings = EstimateSettings(method=FitCriterion.OUTPUT_ERROR, starts=3)
    sensed = with_sensors(model_named("nomoto"), Sensors(yaw_rate_bias=True))
    before = begin_estimate(model_named("nomoto"), runs, settings, options)
    near = begin_estimate(sensed, runs, settings, options, near=before)
    assert near.starts.attempts == before.starts.attempts
    anew = begin_estimate(sensed, runs, settings, options)
    np.testing.assert_allclose(near.shooting.common_parameters, anew.shooting.common_parameters, rtol=1e-4, atol=1e-6)
    spent = [begun.shooting.optimum.solution.evaluations for begun in (near, anew)]
    assert near.starts.start.common_parameters[0] == before.shooting.common_parameters[0] and spent[0] <= spent[1]


def test_one_start_suffices_unless_thrusters_drive_the_craft_or_the_trial_says_otherwise() -> None:
    assert number_of_starts(model_named("nomoto"), None) == 1
    assert number_of_starts(model_named("nomoto"), 5) == 5
    assert number_of_starts(model_named("thrusters"), None) == 6
