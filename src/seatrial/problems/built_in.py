"""The methods that come with seatrial: its searches and estimators, and those of packages that it depends on."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from math import ceil

import numpy as np

from seatrial.data.trial import EstimateMethod
from seatrial.estimation.search import SearchBudget, search_method
from seatrial.numerics.optimise import FitnessMemory, levenberg_marquardt
from seatrial.problems import adapters
from seatrial.problems.ask_tell import searched
from seatrial.problems.estimate import Estimate
from seatrial.problems.posed import PosedProblem

RANDOM, OUTPUT_ERROR, IDENTIFY = "random", "output-error", "identify"
"""Names of the trivial baseline and of the package's own estimators."""
_SEARCHES = (
    EstimateMethod.PSO, EstimateMethod.WHO, EstimateMethod.IWHO, EstimateMethod.ICPSO, EstimateMethod.DE,
    EstimateMethod.CMA_ES,
)  # fmt: skip
_RANDOM_POINTS = 40  # points of one call of the random search, as the populations have them
_NO_LOCAL = np.zeros((0, 0))
_NEGLIGIBLE = 1e-8  # relative step of the cost at which the own estimator ends; ours, far below any bound


@dataclass(frozen=True)
class BuiltIn:
    """One method: its name, its source, the package whose version it depends on, and what it does."""

    name: str
    source: str
    package: str
    estimate: Callable[[PosedProblem, np.random.Generator], Estimate]
    suits: Callable[[PosedProblem], bool]

    def digest(self) -> str:
        """Return package and version, on which its answers depend."""
        try:
            return f"{self.package} {version(self.package)}" if self.package else ""
        except PackageNotFoundError:
            return f"{self.package} not installed"


def _is_any(_: PosedProblem) -> bool:
    return True


def _is_constant(problem: PosedProblem) -> bool:
    """Methods that remember points without judging them again need a fitness that does not change."""
    return not problem.is_changing


def _has_residuals(problem: PosedProblem) -> bool:
    return problem.least_squares is not None


def _has_trial(problem: PosedProblem) -> bool:
    return problem.trial is not None


def _random_search(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """Uniform random points of the box; the budget ends it."""
    while True:
        points = problem.box.random_points(rng, _RANDOM_POINTS)
        values = problem.fitness(points)
        if problem.is_changing:
            problem.declare_best(points[int(np.argmin(values))])


def _published_search(name: EstimateMethod, problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """A published search, its length fitted to the budget, points judged again where the fitness changes."""
    method = search_method(name)
    population = method.population(problem.box.size)
    memory = FitnessMemory.RE_EVALUATE if problem.is_changing else FitnessMemory.KEEP
    create = method.within(SearchBudget(population, ceil(problem.budget / population), memory))
    return searched(create(problem.box, rng), problem)


def _output_error(problem: PosedProblem, _: np.random.Generator) -> Estimate:
    """Levenberg-Marquardt from the start; covariance by the information matrix."""
    assert problem.least_squares is not None
    optimum = levenberg_marquardt(problem.least_squares, problem.start, _NO_LOCAL, negligible=_NEGLIGIBLE)
    covariance = np.asarray(np.linalg.pinv(optimum.normal.hessian), dtype=np.float64)
    return Estimate(optimum.solution.point, covariance)


def _identify(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """What `seatrial identify` answers by default."""
    from seatrial.estimation.identify import identify

    assert problem.trial is not None
    fit = identify(problem.trial, int(rng.integers(2**31)))
    by_name = {c.name: c for c in fit.coefficients}
    values = np.array([by_name[name].estimate for name in problem.unknowns])
    errors = [by_name[name].standard_error for name in problem.unknowns]
    has_errors = all(error is not None and np.isfinite(error) and error > 0.0 for error in errors)
    return Estimate(values, np.diag(np.square(np.array(errors, dtype=np.float64))) if has_errors else None)


ENTRIES: tuple[BuiltIn, ...] = (
    BuiltIn(RANDOM, "uniform random points; the trivial baseline", "", _random_search, _is_any),
    *(
        BuiltIn(
            name.value, search_method(name).source, "", partial(_published_search, name),
            _is_any if name in (EstimateMethod.PSO, EstimateMethod.WHO, EstimateMethod.IWHO) else _is_constant,
        )
        for name in _SEARCHES
    ),
    BuiltIn("scipy-de", "SciPy, differential_evolution", "scipy", adapters.scipy_evolution, _is_constant),
    BuiltIn("scipy-annealing", "SciPy, dual_annealing", "scipy", adapters.scipy_annealing, _is_constant),
    BuiltIn("scipy-nelder-mead", "SciPy, minimize, from the start", "scipy", adapters.scipy_simplex, _is_constant),
    BuiltIn("cmaes", "cmaes, CMA", "cmaes", adapters.cmaes_search, _is_constant),
    BuiltIn("pymoo-de", "pymoo, DE", "pymoo", adapters.pymoo_evolution, _is_constant),
    BuiltIn("pymoo-pso", "pymoo, PSO", "pymoo", adapters.pymoo_swarm, _is_constant),
    BuiltIn(OUTPUT_ERROR, "output error by Levenberg-Marquardt from the start", "", _output_error, _has_residuals),
    BuiltIn(IDENTIFY, "seatrial identify, defaults", "", _identify, _has_trial),
)  # fmt: skip
