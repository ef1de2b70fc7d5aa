"""The problem of a trial: residuals, Jacobian and fitness agree."""

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Prior, Record, Ship
from seatrial.data.trial import EstimateSettings, Run, Trial
from seatrial.estimation.estimate.trial_problem import TrialProblem
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import replay

SHIP = Ship("tanker", {"L": 8.0})


def steered_record(model: Model, name: str) -> Record:
    time = 0.5 * np.arange(81)
    delta = (0.3 if name == "a" else 0.2) * np.sign(np.sin(0.12 * time))
    truth = replay(model, Record.from_arrays(name, time, {"delta": delta}), {"r": 0.0})
    return Record.from_arrays(name, time, {"delta": delta, "u": np.full(81, 2.0), "r": truth["r"], "psi": truth["psi"]})


@pytest.fixture(scope="module")
def model() -> Model:
    known = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
    return known.with_parameters(known.parameters.with_priors({"T": Prior(8.5, 3.0)}).bounded("K", 0.01, 1.0))


@pytest.fixture(scope="module")
def problem(model: Model) -> TrialProblem:
    runs = (Run(steered_record(model, "a")), Run(steered_record(model, "b")))
    settings = EstimateSettings(segment_s=10.0, offsets={"delta": 0.05}, delays={"delta": 0.0}, channels=("psi", "r"))
    return Trial(SHIP, runs, model, estimate=settings, noise={"psi": 0.01}).problem()


def test_unknowns_are_named_and_bounded(problem: TrialProblem) -> None:
    segments = problem.output_error.data.count
    assert problem.names[:4] == ("K", "T", "delta zero of a", "delta zero of b")
    assert len(problem.names) == len(problem.start) == 4 + 2 * segments
    assert (problem.bounds.lower[0], problem.bounds.upper[0]) == (0.01, 1.0)
    assert np.all(np.isinf(problem.bounds.lower[2:])) and np.all(np.isinf(problem.bounds.upper[2:]))
    assert problem.output_error.noise[problem.output_error.data.outputs.index("psi")] == 0.01


def test_half_the_sum_of_squares_is_the_fitness(problem: TrialProblem) -> None:
    points = problem.start + np.array([[0.0], [1e-3], [-2e-3]])
    values = [0.5 * np.sum(problem.residuals(point) ** 2) for point in points]
    np.testing.assert_allclose(problem.fitness(points), values, rtol=1e-12)
    assert values[0] < values[1]


def test_the_jacobian_is_that_of_the_residuals(problem: TrialProblem) -> None:
    point = problem.start + 1e-3
    jacobian = problem.jacobian(point)
    for column in (0, 1, 2, 3, 4, len(point) - 1):
        step = np.zeros(len(point))
        step[column] = 1e-6
        difference = (problem.residuals(point + step) - problem.residuals(point - step)) / 2e-6
        np.testing.assert_allclose(jacobian[:, column], difference, atol=1e-6 * np.max(np.abs(difference)))
