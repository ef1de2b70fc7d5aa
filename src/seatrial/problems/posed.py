"""A problem as a method sees it: everything but the truth; every evaluation is counted."""

from dataclasses import dataclass, field

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.data.trial import Trial
from seatrial.numerics.optimise import Box, LeastSquaresProblem, NormalEquations
from seatrial.problems.problem import BenchmarkProblem, ProblemDraw

_NO_LOCAL = np.zeros((0, 0))


class BudgetSpent(Exception):
    """Ends a method that would evaluate more than its budget; the best point so far is its answer."""


@dataclass(eq=False)
class EvaluationMeter:
    """Counts evaluations and keeps the best point so far after each call.

    Attributes:
        count: evaluations so far; calls: of the fitness, each an iteration of a search.
        trace: evaluations so far and the best point then (d,), a row for each improvement.
        is_spent: whether a method was ended by it.
    """

    budget: int
    count: int = 0
    calls: int = 0
    best_fitness: float = np.inf
    trace: list[tuple[int, Array]] = field(default_factory=list)
    is_spent: bool = False

    def spend(self, evaluations: int) -> None:
        """Raises:
        BudgetSpent: nothing of the budget is left.
        """
        if self.count >= self.budget:
            self.is_spent = True
            raise BudgetSpent
        self.count += evaluations

    def compare(self, point: Array, fitness: float) -> None:
        """Keep a point that is better than all before."""
        if fitness < self.best_fitness:
            self.best_fitness = fitness
            self.trace.append((self.count, np.array(point)))


@dataclass(frozen=True, eq=False)
class CountedLeastSquares:
    """A least-squares problem in the box of the benchmark, its evaluations counted: a slope counts as one each."""

    problem: LeastSquaresProblem
    lower: Array
    upper: Array
    meter: EvaluationMeter

    def cost(self, shared: Array, local: Array = _NO_LOCAL) -> float:
        """Return half the sum of squared residuals in standard deviations at a point (d,)."""
        self.meter.spend(1)
        cost = self.problem.cost(shared, local)
        self.meter.compare(shared, cost)
        return cost

    def normal(self, shared: Array, local: Array = _NO_LOCAL) -> NormalEquations:
        """Return cost, gradient (d,) and Gauss-Newton Hessian (d, d) at a point (d,)."""
        self.meter.spend(1 + len(shared))
        normal = self.problem.normal(shared, local)
        self.meter.compare(shared, normal.cost)
        return normal


@dataclass(frozen=True, eq=False)
class PosedProblem:
    """What a method is given.

    Attributes:
        name, title, noise: of the problem, in words.
        unknowns, units: names and SI units, (d,).
        box: bounds of the unknowns; start: values before any search (d,), inside the box.
        budget: evaluations that may be spent; beyond it `fitness` and `least_squares` raise `BudgetSpent`, which need
            not be caught.
        is_changing: whether the fitness differs from call to call; a point remembered must then be judged again.
        least_squares: cost, gradient and Gauss-Newton Hessian; None where the problem has no residuals.
        trial: records and model, whose free parameters are the unknowns; None where the problem has no records.
    """

    name: str
    title: str
    noise: str
    unknowns: tuple[str, ...]
    units: tuple[str, ...]
    box: Box
    start: Array
    budget: int
    is_changing: bool
    least_squares: CountedLeastSquares | None
    trial: Trial | None
    _draw: ProblemDraw
    _meter: EvaluationMeter

    def fitness(self, points: Array) -> Array:
        """Return the fitness (n,) of points (n, d), to be made small; each row counts as one evaluation.

        Raises:
            BudgetSpent: the budget is spent; no answer is needed then.
            InputError: the points have another shape, or are not finite.
        """
        points = np.array(points, dtype=np.float64, ndmin=2)
        if points.ndim != 2 or points.shape[1] != self.box.size or not np.all(np.isfinite(points)):
            raise InputError(f"fitness takes finite points of shape (n, {self.box.size}), not {points.shape}")
        return self.fitness_inside(points)

    def fitness_inside(self, points: Array) -> Array:
        """Return the fitness (n,) of finite points (n, d), which are not checked again.

        Raises:
            BudgetSpent: as `fitness`.
        """
        meter = self._meter
        meter.spend(len(points))
        values = self._draw.fitness(points, meter.calls)
        meter.calls += 1
        if len(points) and not self.is_changing:
            least = values.argmin()
            if values[least] < meter.best_fitness:
                meter.compare(points[least], float(values[least]))
        return values

    @property
    def best_points(self) -> tuple[tuple[int, Array], ...]:
        """Evaluations so far and the best point then (d,), a row for each improvement."""
        return tuple(self._meter.trace)

    def declare_best(self, point: Array) -> None:
        """Keep the best point so far (d,) as the method sees it, where the fitness changes and cannot say."""
        self._meter.trace.append((self._meter.count, np.array(point, dtype=np.float64)))


def posed(problem: BenchmarkProblem, draw: ProblemDraw, meter: EvaluationMeter) -> PosedProblem:
    """Return a draw as a method sees it."""
    middle = 0.5 * (draw.box.lower + draw.box.upper)
    start = middle if draw.start is None else np.clip(draw.start, draw.box.lower, draw.box.upper)
    start.flags.writeable = False
    counted = None
    if draw.least_squares is not None:
        counted = CountedLeastSquares(draw.least_squares, draw.box.lower, draw.box.upper, meter)
    return PosedProblem(
        problem.name, problem.title, problem.noise, draw.unknowns, draw.units, draw.box, start, problem.budget,
        problem.is_changing, counted, draw.trial, draw, meter,
    )  # fmt: skip
