"""A method against a draw: its answer, and the sentence for each thing that it may not do."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box
from seatrial.problems import (
    BenchmarkProblem,
    EnteredMethod,
    Estimate,
    MethodError,
    Placement,
    PosedProblem,
    attempt,
    built_in_methods,
    repeats_itself,
)
from seatrial.problems.method import searched


def method(estimate: object) -> EnteredMethod:
    """A method of a function."""
    return EnteredMethod("of a test", "", "", False, estimate)  # type: ignore[arg-type]


class Steps:
    """An optimiser that asks for one point for ever."""

    def __init__(self, box: Box, point: Array | None = None) -> None:
        self.point = np.zeros((1, box.size)) if point is None else point
        self.best = (np.zeros(box.size), math.inf)

    def ask(self) -> Array:
        return self.point

    def tell(self, fitness: Array) -> None:
        self.best = (self.point[0], float(fitness[0]))


@pytest.mark.parametrize("name", sorted(built_in_methods()))
def test_every_built_in_method_answers_and_repeats_itself(name: str, paraboloid: BenchmarkProblem) -> None:
    one = built_in_methods()[name]
    if name == "identify":
        return  # needs records
    answer = attempt(one, paraboloid, seed=3)
    yardstick = paraboloid.draw(3).yardstick
    assert yardstick.error(answer.values) < 3.0
    assert answer.evaluations <= paraboloid.budget + 60, "the population that passes the end of the budget"
    assert repeats_itself(one, paraboloid, 3, Placement.SHIFTED, answer)
    counts = [count for count, _ in answer.trace]
    assert counts == sorted(counts) and counts


def test_the_own_estimator_states_its_covariance_and_needs_few_evaluations(paraboloid: BenchmarkProblem) -> None:
    answer = attempt(built_in_methods()["output-error"], paraboloid, seed=0)
    draw = paraboloid.draw(0)
    assert draw.least_squares is not None
    assert draw.least_squares.cost(answer.values, np.zeros((0, 0))) < 1e-12
    np.testing.assert_allclose(answer.covariance, np.eye(2), atol=1e-9)  # type: ignore[arg-type]
    assert answer.evaluations < 20 and not answer.is_budget_spent


def test_a_search_that_never_stops_ends_with_its_budget(paraboloid: BenchmarkProblem) -> None:
    endless = method(lambda problem, _: searched(Steps(problem.box), problem))
    answer = attempt(endless, paraboloid, 0)
    assert answer.is_budget_spent and answer.evaluations == paraboloid.budget
    np.testing.assert_array_equal(answer.values, 0.0)


def test_an_estimator_beyond_its_budget_answers_its_best_point(paraboloid: BenchmarkProblem) -> None:
    def endless(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
        while True:
            problem.fitness(problem.box.random_points(rng, 7))

    answer = attempt(method(endless), paraboloid, 0)
    assert answer.is_budget_spent and paraboloid.budget <= answer.evaluations < paraboloid.budget + 7
    np.testing.assert_array_equal(answer.values, answer.trace[-1][1])


def outside(problem: PosedProblem, _: object) -> Estimate:
    return searched(Steps(problem.box, np.full((1, 2), 11.0)), problem)


def wrong_points(problem: PosedProblem, _: object) -> Estimate:
    return searched(Steps(problem.box, np.zeros((2, 3))), problem)


def no_points(problem: PosedProblem, _: object) -> Estimate:
    return searched(Steps(problem.box, np.full((1, 2), np.nan)), problem)


def raises(*_: object) -> Array:
    raise ZeroDivisionError("no time step\nat all")


def writes(problem: PosedProblem, _: object) -> Array:
    problem.start[0] = 1.0
    return problem.start


def writes_by_force(problem: PosedProblem, _: object) -> Array:
    problem.start.flags.writeable = True
    problem.start[0] += 1.0
    return problem.start


@pytest.mark.parametrize(
    ("estimate", "sentence"),
    [
        (raises, "it raises ZeroDivisionError: no time step at all"),
        (outside, "leaves the box: a = 11, allowed are -10 to 10"),
        (wrong_points, r"ask\(\) returns the shape \(2, 3\), not \(n, 2\)"),
        (no_points, "ask\\(\\) returns a point that is not finite"),
        (writes, "changes what it was given"),
        (writes_by_force, "changes what it was given"),
        (lambda *_: np.array([np.nan, 0.0]), "values that are not finite"),
        (lambda *_: np.zeros(3), r"values of shape \(3,\), not \(2,\)"),
        (lambda *_: "soon", "values that are no numbers"),
        (lambda *_: (np.zeros(2), np.eye(3)), "a covariance of shape"),
        (lambda *_: (np.zeros(2), -np.eye(2)), "variances are not positive"),
        (lambda problem, _: problem.fitness(np.zeros(3)), "fitness takes finite points of shape"),
    ],
)
def test_what_a_method_may_not_do_is_one_sentence(
    estimate: object, sentence: str, paraboloid: BenchmarkProblem
) -> None:
    with pytest.raises(MethodError, match=sentence):
        attempt(method(estimate), paraboloid, 0)


def test_a_method_that_draws_from_elsewhere_does_not_repeat_itself(paraboloid: BenchmarkProblem) -> None:
    fresh = method(lambda problem, _: problem.box.random_points(np.random.default_rng(), 1)[0])
    assert not repeats_itself(fresh, paraboloid, 0, Placement.SHIFTED, attempt(fresh, paraboloid, 0))


def test_methods_of_one_seed_meet_the_same_draw_and_others_another(paraboloid: BenchmarkProblem) -> None:
    first, again, other = (paraboloid.draw(seed).yardstick.truth for seed in (1, 1, 2))
    assert first is not None and again is not None and other is not None
    assert first.tobytes() == again.tobytes() != other.tobytes()
    assert not np.any(paraboloid.draw(1, Placement.PUBLISHED).yardstick.truth)
