"""The likelihood with noise levels concentrated out: its gradient, stated noise, and what a divergence costs."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Array, Record
from seatrial.data.trial import EstimateSettings, FitCriterion
from seatrial.estimation.estimate import Runs
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.point_estimate import fit_output_error
from seatrial.estimation.estimate.start import ConcentratedLikelihood
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models import model_named
from seatrial.physics.simulate.replay import replay

NOISE = {"r": 0.002, "psi": 0.005}


def problem_of_a_noisy_run(stated: Mapping[str, float]) -> ConcentratedLikelihood:
    """A zigzag-like run of a first-order ship with white noise, samples of r counting a third."""
    truth = model_named("nomoto").with_values({"K": 0.2, "T": 5.0, "U": 1.0})
    time = np.arange(0.0, 80.0, 0.5)
    planned = Record.from_arrays("run", time, {"delta": 0.3 * np.sign(np.sin(0.2 * time))})
    run = replay(truth, planned, dict.fromkeys(truth.states, 0.0))
    rng = np.random.default_rng(3)
    noisy = {n: run.channel(n).with_values(run[n] + s * rng.standard_normal(len(time))) for n, s in NOISE.items()}
    run = replace(run, channels={"delta": run.channel("delta")} | noisy)
    runs = Runs.one_session_each([run], 10.0)
    settings = EstimateSettings(method=FitCriterion.OUTPUT_ERROR, delays={"delta": 0.0})
    problem = output_error_problem(truth, runs, np.inf, settings)
    inflation = np.where([o == "r" for o in problem.data.outputs], 3.0, 1.0)
    return ConcentratedLikelihood(replace(problem, inflation=inflation), stated)


def start_of(likelihood: ConcentratedLikelihood) -> tuple[Array, Array]:
    return np.array([0.15, 4.0]), likelihood.problem.measured_initial_states()


@pytest.mark.parametrize("stated", [{}, {"r": 0.01}], ids=["estimated", "stated"])
def test_the_gradient_is_that_of_the_cost(stated: dict[str, float]) -> None:
    likelihood = problem_of_a_noisy_run(stated)
    point, local = start_of(likelihood)
    normal = likelihood.normal(point, local)
    assert normal.cost == likelihood.cost(point, local)
    for i, step in enumerate(1e-5 * point):
        ends = [likelihood.cost(point + way * step * np.eye(2)[i], local) for way in (1.0, -1.0)]
        assert normal.gradient[i] == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-5)


def test_one_search_ends_where_searches_and_estimates_of_the_noise_in_turn_do() -> None:
    likelihood = problem_of_a_noisy_run({})
    problem = replace(likelihood.problem, inflation=None)
    optimum = levenberg_marquardt(replace(likelihood, problem=problem), *start_of(likelihood), negligible=1e-9)
    in_turn = fit_output_error(problem, *start_of(likelihood), {})
    assert optimum.solution.point == pytest.approx(in_turn.common_parameters, rel=2e-3)
    settled = likelihood.settled_at(optimum.solution.point, optimum.local)
    assert dict(zip(problem.data.outputs, settled.noise, strict=True)) == pytest.approx(NOISE, rel=0.15)
    assert settled.inflation is None


def test_a_divergence_costs_infinitely_much() -> None:
    likelihood = problem_of_a_noisy_run({})
    point, local = np.array([0.2, -1e-3]), likelihood.problem.measured_initial_states()
    assert likelihood.residuals(point, local) is None
    assert likelihood.cost(point, local) == likelihood.normal(point, local).cost == np.inf
    assert likelihood.settled_at(point, local) is likelihood.problem
