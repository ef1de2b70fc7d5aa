"""Benchmark problems: what each is, a draw of it from a seed, what a method sees, and what answers are measured by."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from fnmatch import fnmatchcase
from functools import cache
from typing import Protocol

import numpy as np

from seatrial._plugins import installed, load_plugin
from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.data.trial import Trial
from seatrial.numerics.optimise import Box, LeastSquaresProblem, NormalEquations

# What a method answers: values, and how sure of them it is.


@dataclass(frozen=True, eq=False)
class Estimate:
    """Values (d,), and their covariance (d, d) where the method states one."""

    values: Array
    covariance: Array | None = None


# What an answer to a benchmark problem is measured by; no method sees it.

_ONE_PERCENT = 0.01
"""Share of the truth that is an error of 1 where there is no noise; chosen."""


class Yardstick(Protocol):
    """Measures answers by one number, 0 for the exact one."""

    @property
    def unit(self) -> str:
        """What an error of 1 is, in words."""
        ...

    @property
    def success_limit(self) -> float:
        """Largest error of an answer that counts as a success."""
        ...

    @property
    def truth(self) -> Array | None:
        """True values (d,); None where nobody knows them."""
        ...

    @property
    def bound(self) -> Array | None:
        """Cramer-Rao bound of the standard errors (d,); None without noise or truth."""
        ...

    def error(self, values: Array) -> float:
        """Return the error of an answer (d,), infinite where it cannot be evaluated."""
        ...


@dataclass(frozen=True, eq=False)
class KnownTruth:
    """Coefficients whose true values are known.

    Attributes:
        truth: (d,).
        bound: Cramer-Rao bound of the standard errors (d,); None: the records have no noise, and errors count in per
            cent of the truth.
    """

    truth: Array
    bound: Array | None = None

    @property
    def unit(self) -> str:
        """What an error of 1 is."""
        return "1 % of the truth, rms over the unknowns" if self.bound is None else "the Cramér-Rao bound, rms"

    @property
    def success_limit(self) -> float:
        """Two bounds, which an efficient estimate of several coefficients hardly ever exceeds, or 1 %; chosen."""
        return 1.0 if self.bound is None else 2.0

    @property
    def scale(self) -> Array:
        """Error of each unknown that counts as 1, (d,)."""
        return _ONE_PERCENT * np.abs(self.truth) if self.bound is None else self.bound

    def error(self, values: Array) -> float:
        """Return the root mean square over the unknowns of the errors in units of the scale."""
        return float(np.sqrt(np.mean(((values - self.truth) / self.scale) ** 2)))


@dataclass(frozen=True, eq=False)
class KnownOptimum:
    """An objective whose least value is known from a search beyond any budget.

    Attributes:
        fitness: points (n, d) -> objective (n,), deterministic.
        least: the least value, positive.
    """

    fitness: Callable[[Array], Array]
    least: float
    truth: None = None
    bound: None = None

    @property
    def unit(self) -> str:
        """What an error of 1 is."""
        return "1 % of the least known objective above it"

    @property
    def success_limit(self) -> float:
        """Within 1 % of the least known objective; chosen."""
        return 1.0

    def error(self, values: Array) -> float:
        """Return by how many per cent the objective lies above the least known one; a smaller one counts as zero."""
        value = float(self.fitness(values[None])[0])
        return max(100.0 * (value / self.least - 1.0), 0.0) if np.isfinite(value) else np.inf


# A benchmark problem: what it is, where it comes from, and how one draw of it comes from a seed.

_STREAM = 20
"""First number of the seed of every draw: chosen, so that draws and methods take different random numbers."""


class Placement(StrEnum):
    """Where the truth lies."""

    SHIFTED = "shifted"
    PUBLISHED = "published"

    @property
    def text(self) -> str:
        """What it means, in words."""
        if self is Placement.SHIFTED:
            description = "a known truth scaled, and shifted from the middle of its box, anew by every seed"
            return f"{description}; of measured trials another session left out"
        return "truth as published, in the middle of its box where the paper has it there"


ChangingFitness = Callable[[Array, int], Array]
"""Points (n, d) and the number of the iteration, from 0 -> fitness (n,); infinite where it cannot be evaluated."""


@dataclass(frozen=True, eq=False)
class ProblemDraw:
    """One draw of a problem.

    Attributes:
        unknowns: names; units: SI, of each.
        box: bounds of the search.
        fitness: what optimisers make small.
        start: values that need no search, from physics or an earlier model (d,); without it the middle of the box.
        least_squares: half the sum of squared residuals in standard deviations with its slopes, initial states held.
        trial: records and model; the model's values are those of the start.
        yardstick: what an answer is measured by.
    """

    unknowns: tuple[str, ...]
    units: tuple[str, ...]
    box: Box
    fitness: ChangingFitness
    yardstick: Yardstick
    start: Array | None = None
    least_squares: LeastSquaresProblem | None = None
    trial: Trial | None = None


@dataclass(frozen=True)
class PaperClaim:
    """What a paper says of two methods on its problem.

    Attributes:
        text: one sentence; better, worse: names of built-in methods.
    """

    text: str
    better: str
    worse: str


@dataclass(frozen=True)
class BenchmarkProblem:
    """A named, versioned problem.

    Attributes:
        name: family, then what distinguishes it, with dashes.
        version: raised by whatever changes a draw; part of the identity of every result.
        title: one line; source: where it was published.
        noise: of the records, in words; budget: evaluations that a method may spend.
        is_changing: whether the fitness differs from iteration to iteration, as one that judges sample by sample.
        draw_with: makes a draw from random numbers.
        claims: what its paper says of methods on it.
    """

    name: str
    version: int
    title: str
    source: str
    noise: str
    budget: int
    draw_with: Callable[[np.random.Generator, Placement], ProblemDraw]
    is_changing: bool = False
    claims: tuple[PaperClaim, ...] = ()

    @property
    def label(self) -> str:
        """Name and version, as citations have them."""
        return f"{self.name}@{self.version}"

    def draw(self, seed: int, placement: Placement = Placement.SHIFTED) -> ProblemDraw:
        """Return the draw of a seed: the same bits for the same seed."""
        return self.draw_with(np.random.default_rng([_STREAM, seed]), placement)


# A problem as a method sees it: everything but the truth; every evaluation is counted.

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


# Problems by name: those of the studies, and those that other packages install under ``seatrial.problems``.

ENTRY_POINT_GROUP = "seatrial.problems"


def list_problems() -> tuple[BenchmarkProblem, ...]:
    """Return all installed problems, family after family; those whose records are absent are left out.

    Raises:
        InputError: an installed family cannot be loaded; the package is named.
    """
    absent = absent_families()
    names = (name for name in installed(ENTRY_POINT_GROUP) if name not in absent)
    return tuple(problem for name in names for problem in _family(name))


def absent_families() -> Mapping[str, str]:
    """Return the families whose records are not here, with the reason, what to do included.

    Raises:
        InputError: as `list_problems`.
    """
    reasons = {}
    for name in installed(ENTRY_POINT_GROUP):
        make = load_plugin(ENTRY_POINT_GROUP, name, InputError)
        try:
            make()
        except InputError as error:
            reasons[name] = str(error)
    return reasons


def problem_named(name: str) -> BenchmarkProblem:
    """Return the problem of a name.

    Raises:
        InputError: there is none; the nearest is named. Or its records are not here.
    """
    family = name.partition("-")[0]
    problems = _family(family) if family in installed(ENTRY_POINT_GROUP) else ()
    for problem in problems:
        if problem.name == name:
            return problem
    names = [p.name for p in problems or list_problems()]
    raise InputError(f"there is no problem '{name}'{spelling_hint(name, names)}")


def problems_matching(patterns: tuple[str, ...]) -> tuple[BenchmarkProblem, ...]:
    """Return the problems of names, families (``qi2025``) and patterns (``qi2025-*-whole``), each once.

    Raises:
        InputError: a pattern matches none, or the records of a family that is named are not here.
    """
    matching: dict[str, BenchmarkProblem] = {}
    for pattern in patterns:
        if pattern in installed(ENTRY_POINT_GROUP):
            problems = _family(pattern)
        elif any(sign in pattern for sign in "*?["):
            problems = tuple(p for p in list_problems() if fnmatchcase(p.name, pattern))
        else:
            problems = (problem_named(pattern),)
        if not problems:
            raise InputError(f"no problem matches '{pattern}'; 'seatrial benchmark --list' names them")
        matching |= {p.name: p for p in problems}
    return tuple(matching.values())


@cache
def _family(name: str) -> tuple[BenchmarkProblem, ...]:
    """The problems of one entry point, a function without arguments; it raises InputError where records are absent."""
    return tuple(load_plugin(ENTRY_POINT_GROUP, name, InputError)())
