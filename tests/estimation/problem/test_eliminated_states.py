"""The cost by the shared unknowns alone, against a search of the initial states with these held."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.identify.conftest import NOISE, TRUTH, square, steered

from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import estimate_model
from seatrial.estimation.problem.output_error import EliminatedStates
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models.nomoto import nomoto


@pytest.mark.parametrize("segment", [None, 20.0])
def test_the_cost_is_that_of_the_best_initial_states(segment: float | None) -> None:
    rng = np.random.default_rng(2)
    run = steered(nomoto().with_values(TRUTH), square(400), rng, NOISE)
    settings = EstimateSettings(segment_s=segment, delays={"delta": 0.0})
    estimation = estimate_model(nomoto(), Runs.one_session_each((run,), 8.0), settings)
    problem, optimum = estimation.estimate.problem, estimation.estimate.optimum
    point, error = estimation.estimate.common_parameters, estimation.interval.standard_error
    near = EliminatedStates.about(problem, point, optimum.local, optimum.normal)
    assert near.cost(point) == pytest.approx(optimum.solution.value, rel=1e-9)
    for away in ([3.0, 0.0], [-2.0, 2.0], [5.0, 5.0]):
        shared = point + np.array([*away, *np.zeros(len(point) - 2)]) * error
        held = replace(problem, pinned=shared)
        exact = levenberg_marquardt(held, shared, optimum.local, negligible=1e-10).solution.value
        stayed = problem.cost(shared, optimum.local)
        assert near.cost(shared) == pytest.approx(exact, abs=0.01)  # a per cent of a nat
        assert stayed >= exact


def test_a_run_that_diverges_costs_infinitely_much() -> None:
    rng = np.random.default_rng(2)
    run = steered(nomoto().with_values(TRUTH), square(400), rng, NOISE)
    estimation = estimate_model(nomoto(), Runs.one_session_each((run,), 8.0))
    optimum = estimation.estimate.optimum
    near = EliminatedStates.about(
        estimation.estimate.problem, estimation.estimate.common_parameters, optimum.local, optimum.normal
    )
    assert near.cost(np.where(np.arange(len(near.shared)) == 1, -1e-3, near.shared)) == np.inf
