"""Restarts of least squares, and least-squares problems of the house under every optimiser."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.numerics.optimise.landscapes import KINDS, make_optimiser

from seatrial.numerics.optimise import (
    Box,
    NormalEquations,
    RestartSettings,
    SearchError,
    Status,
    fitness_function,
    levenberg_marquardt,
    multistart,
    search,
)

Array = NDArray[np.float64]
NONE = np.zeros((0, 0))
TIME = np.linspace(0.0, 6.0, 60)
TRUTH = np.array([1.5, 4.0])


@dataclass(frozen=True)
class Sine:
    """Amplitude and frequency of a sine: many local minima in the frequency."""

    lower: Array
    upper: Array

    def cost(self, shared: Array, local: Array) -> float:
        assert local.size == 0
        error = shared[0] * np.sin(shared[1] * TIME) - TRUTH[0] * np.sin(TRUTH[1] * TIME)
        return 0.5 * float(error @ error) if shared[1] < 9.5 else np.inf

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        a, omega = shared
        error = a * np.sin(omega * TIME) - TRUTH[0] * np.sin(TRUTH[1] * TIME)
        slope = np.stack([np.sin(omega * TIME), a * TIME * np.cos(omega * TIME)], axis=1)
        empty = np.zeros((0, 2, 0))
        return NormalEquations(
            self.cost(shared, local), slope.T @ error, slope.T @ slope, np.zeros((0, 0)), np.zeros((0, 0, 0)), empty
        )


BOX = Box(np.array([0.2, 0.5]), np.array([5.0, 10.0]))
PROBLEM = Sine(BOX.lower, BOX.upper)
TRAP = np.array([1.0, 8.0])


@pytest.mark.parametrize("kind", KINDS)
def test_every_optimiser_solves_a_least_squares_problem(kind: str) -> None:
    solution = search(make_optimiser(kind, BOX, 1), fitness_function(PROBLEM))
    assert np.allclose(solution.point, TRUTH, rtol=2e-3)


def test_a_good_start_is_not_started_again() -> None:
    found = multistart(PROBLEM, np.array([1.0, 4.2]), BOX, np.random.default_rng(0), RestartSettings(1e-12))
    assert (found.restarts, found.is_accepted) == (0, True)
    assert np.allclose(found.solution.point, TRUTH, rtol=1e-9)
    assert found.solution.status is Status.CONVERGED


def test_restarts_leave_a_local_minimum_that_one_start_does_not() -> None:
    alone = levenberg_marquardt(PROBLEM, TRAP, NONE).solution
    assert alone.value > 1.0
    found = multistart(PROBLEM, TRAP, BOX, np.random.default_rng(0), RestartSettings(1e-12, max_restarts=60))
    assert found.is_accepted
    assert 1 <= found.restarts <= 60
    assert len(found.solution.history) == found.restarts + 1
    assert found.solution.evaluations > alone.evaluations
    assert np.allclose(found.solution.point, TRUTH, rtol=1e-9)
    again = multistart(PROBLEM, TRAP, BOX, np.random.default_rng(0), RestartSettings(1e-12, max_restarts=60))
    assert again.solution.history == found.solution.history
    assert again.solution.seed == 0


def test_spent_restarts_return_the_best_and_say_so() -> None:
    found = multistart(PROBLEM, TRAP, BOX, np.random.default_rng(0), RestartSettings(-1.0, max_restarts=3))
    assert (found.restarts, found.is_accepted) == (3, False)
    assert found.solution.value == min(found.solution.history) == PROBLEM.cost(found.solution.point, NONE)


def test_starts_in_another_scale_are_carried_over() -> None:
    logarithms = Box(np.log(BOX.lower), np.log(BOX.upper))
    found = multistart(
        PROBLEM, TRAP, logarithms, np.random.default_rng(0), RestartSettings(1e-12, max_restarts=60), transform=np.exp
    )
    assert found.is_accepted
    assert np.allclose(found.solution.point, TRUTH, rtol=1e-9)


def test_a_start_that_cannot_be_evaluated_is_left() -> None:
    found = multistart(
        PROBLEM, np.array([1.0, 9.9]), BOX, np.random.default_rng(0), RestartSettings(1e-12, max_restarts=60)
    )
    assert found.is_accepted
    assert found.restarts >= 1


@dataclass(frozen=True)
class Holed(Sine):
    """Not a number at low frequencies, where a model's own check would be missing."""

    def cost(self, shared: Array, local: Array) -> float:
        return np.nan if shared[1] < 3.5 else super().cost(shared, local)


def test_a_start_without_a_value_neither_ends_the_search_nor_takes_the_place_of_one() -> None:
    holed = Holed(BOX.lower, BOX.upper)
    left = multistart(
        holed, np.array([1.0, 2.0]), BOX, np.random.default_rng(0), RestartSettings(1e-12, max_restarts=60)
    )
    assert left.is_accepted
    low = Box(np.array([0.2, 0.5]), np.array([5.0, 3.0]))
    kept = multistart(holed, TRAP, low, np.random.default_rng(0), RestartSettings(1e-12, max_restarts=3))
    alone = levenberg_marquardt(holed, TRAP, NONE).solution
    assert (kept.restarts, kept.solution.value) == (3, alone.value)


def test_senseless_restarts_are_refused() -> None:
    with pytest.raises(SearchError, match="NaN"):
        RestartSettings(np.nan)
    with pytest.raises(SearchError, match="-1 restarts"):
        RestartSettings(0.0, max_restarts=-1)
    with pytest.raises(SearchError, match="the box has 2 unknowns"):
        multistart(PROBLEM, np.zeros(3), BOX, np.random.default_rng(0), RestartSettings(0.0))
