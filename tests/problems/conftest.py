"""A problem of two unknowns whose answer is known: a paraboloid with noise of variance 1."""

from dataclasses import dataclass

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, NormalEquations
from seatrial.problems import BenchmarkProblem, KnownTruth, Placement, ProblemDraw

NONE = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class Paraboloid:
    """Half the squared distance from `optimum`, in standard deviations."""

    optimum: Array
    lower: Array
    upper: Array

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        return 0.5 * float(np.sum((shared - self.optimum) ** 2))

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        gap = shared - self.optimum
        return NormalEquations(self.cost(shared, local), gap, np.eye(len(gap)), NONE, NONE, NONE)


def drawn(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
    """The truth lies off the middle where the placement shifts it; the optimum has an error of variance 1."""
    truth = rng.uniform(-3.0, 3.0, 2) if placement is Placement.SHIFTED else np.zeros(2)
    box = Box(np.full(2, -10.0), np.full(2, 10.0))
    problem = Paraboloid(truth + rng.standard_normal(2), box.lower, box.upper)
    return ProblemDraw(
        ("a", "b"), ("1", "m"), box, lambda points, _: np.array([problem.cost(p, NONE) for p in points]),
        KnownTruth(truth, np.ones(2)), None, problem,
    )  # fmt: skip


@pytest.fixture
def paraboloid() -> BenchmarkProblem:
    """The problem."""
    return BenchmarkProblem("toy-2", 1, "a paraboloid", "none", "variance 1", 500, drawn)
