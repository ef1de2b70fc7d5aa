"""Methods that are entered against the problems: built-in, installed, or of a user's file; those of other packages."""

import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from math import ceil
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import Any, Protocol, runtime_checkable

import numpy as np

from seatrial._plugins import installed, load_plugin
from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.data.trial import SEARCHES, EstimateMethod
from seatrial.numerics.optimise import SEARCH_METHODS, FitnessMemory, SearchBudget, levenberg_marquardt
from seatrial.problems.problem import BudgetSpent, Estimate, PosedProblem

# Optimisers that ask and tell, run within a budget and held to their box.


class MethodError(InputError):
    """States what a method does that it may not, in one sentence."""


@runtime_checkable
class Asking(Protocol):
    """What makes a class an optimiser."""

    def ask(self) -> Array:
        """Return points to evaluate next, (n, d), inside the box."""
        ...

    def tell(self, fitness: Array) -> None:
        """Take their fitness (n,)."""
        ...


class AskTell(Asking, Protocol):
    """What a run asks of an optimiser; `done` may be absent, its budget then ends it."""

    @property
    def best(self) -> tuple[Array, float]:
        """Return the point it would answer now (d,), and its fitness."""
        ...


def searched(optimiser: AskTell, problem: PosedProblem) -> Estimate:
    """Return the best point of an optimiser that has run to its end, or to that of the budget.

    Raises:
        MethodError: points of another shape, not finite, or outside the box.
    """
    try:
        while not getattr(optimiser, "done", False):
            points = np.asarray(optimiser.ask(), dtype=np.float64)
            if not _is_inside(points, problem):
                raise _misplaced(points, problem)
            optimiser.tell(problem.fitness_inside(points))
            if problem.is_changing:
                problem.declare_best(optimiser.best[0])
    except BudgetSpent:
        pass  # the meter keeps that
    return Estimate(np.array(optimiser.best[0], dtype=np.float64))


def _is_inside(points: Array, problem: PosedProblem) -> bool:
    """Whether the points of an ask have their shape and lie in the box; those that are not finite do not."""
    box = problem.box
    has_shape = points.ndim == 2 and points.shape[1] == box.size and len(points) > 0
    # counted, as `all` costs three times what the comparison does
    return (
        has_shape
        and np.count_nonzero(points >= box.lower) == points.size
        and np.count_nonzero(points <= box.upper) == points.size
    )


def _misplaced(points: Array, problem: PosedProblem) -> MethodError:
    """What is wrong with the points of an ask."""
    size, box = problem.box.size, problem.box
    if points.ndim != 2 or points.shape[1] != size or not len(points):
        return MethodError(f"ask() returns the shape {points.shape}, not (n, {size})")
    if not np.all(np.isfinite(points)):
        return MethodError("ask() returns a point that is not finite")
    row, column = np.argwhere((points < box.lower) | (points > box.upper))[0]
    return MethodError(
        f"ask() leaves the box: {problem.unknowns[column]} = {points[row, column]:g}, allowed are "
        f"{box.lower[column]:g} to {box.upper[column]:g}; clip it"
    )


# Optimisers of other packages as methods; each package is imported when it is used.

_WIDTH = 0.3
"""First standard deviation of a search in the unit box: a third, as Hansen 2016 (arXiv:1604.00772, C) advises."""
_LARGEST_SEED = 2**31
"""Seeds of other packages lie below this."""
_LARGEST = 1e300  # what stands for an infinite fitness where a package adds or averages values; chosen


def scipy_evolution(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """Run `scipy.optimize.differential_evolution` in the box, without polishing, until the budget ends it."""
    optimize = _imported("scipy.optimize", "scipy")
    result = optimize.differential_evolution(
        lambda columns: problem.fitness(columns.T), _bounds(problem), rng=rng, maxiter=problem.budget, polish=False,
        updating="deferred", vectorized=True,
    )  # fmt: skip
    return Estimate(result.x)


def scipy_annealing(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """Run `scipy.optimize.dual_annealing` in the box until the budget ends it."""
    optimize = _imported("scipy.optimize", "scipy")
    result = optimize.dual_annealing(_single(problem), _bounds(problem), rng=rng, maxfun=problem.budget)
    return Estimate(result.x)


def scipy_simplex(problem: PosedProblem, rng: np.random.Generator) -> Estimate:  # noqa: ARG001  # draws nothing
    """Run the simplex of Nelder and Mead in the unit box from the start, then again from where it ends."""
    optimize = _imported("scipy.optimize", "scipy")
    box, best = problem.box, (problem.start - problem.box.lower) / problem.box.width
    judged, least = _single(problem), np.inf
    while True:
        result = optimize.minimize(
            lambda unit: judged(box.scaled(unit)), best, method="Nelder-Mead", bounds=[(0.0, 1.0)] * box.size
        )
        if not result.fun < least:
            return Estimate(box.scaled(best))
        best, least = result.x, result.fun


def cmaes_search(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """Run the CMA-ES of the package cmaes in the unit box."""
    return searched(_CmaesSearch(problem, rng), problem)


def pymoo_evolution(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """Run the differential evolution of pymoo."""
    return searched(_PymooSearch(problem, rng, _imported("pymoo.algorithms.soo.nonconvex.de", "pymoo").DE()), problem)


def pymoo_swarm(problem: PosedProblem, rng: np.random.Generator) -> Estimate:
    """Run the particle swarm of pymoo."""
    return searched(_PymooSearch(problem, rng, _imported("pymoo.algorithms.soo.nonconvex.pso", "pymoo").PSO()), problem)


class _CmaesSearch:
    """The package gives one point at a time and takes the fitness of a whole generation."""

    def __init__(self, problem: PosedProblem, rng: np.random.Generator) -> None:
        unit = np.repeat([[0.0, 1.0]], problem.box.size, axis=0)
        self._box = problem.box
        self._search = _imported("cmaes", "cmaes").CMA(
            np.full(problem.box.size, 0.5), _WIDTH, bounds=unit, seed=int(rng.integers(_LARGEST_SEED))
        )
        self.best: tuple[Array, float] = (0.5 * (self._box.lower + self._box.upper), np.inf)

    @property
    def done(self) -> bool:
        """Whether nothing is left to improve."""
        return self._search.should_stop()

    def ask(self) -> Array:
        """Return a generation, (n, d)."""
        self._units = [self._search.ask() for _ in range(self._search.population_size)]
        return self._box.scaled(np.array(self._units))

    def tell(self, fitness: Array) -> None:
        """Take its fitness (n,)."""
        self.best = _better(self.best, self._box.scaled(np.array(self._units)), fitness)
        self._search.tell([(u, float(min(f, _LARGEST))) for u, f in zip(self._units, fitness, strict=True)])


class _PymooSearch:
    """An algorithm of pymoo, population by population."""

    def __init__(self, problem: PosedProblem, rng: np.random.Generator, algorithm: Any) -> None:
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination

        box = problem.box
        space = Problem(n_var=box.size, n_obj=1, xl=box.lower.copy(), xu=box.upper.copy())
        algorithm.setup(space, termination=NoTermination(), seed=int(rng.integers(_LARGEST_SEED)), verbose=False)
        self._box, self._algorithm = box, algorithm
        self.best: tuple[Array, float] = (0.5 * (box.lower + box.upper), np.inf)

    def ask(self) -> Array:
        """Return a population, (n, d)."""
        self._population = self._algorithm.ask()
        return np.clip(self._population.get("X"), self._box.lower, self._box.upper)

    def tell(self, fitness: Array) -> None:
        """Take its fitness (n,)."""
        from pymoo.core.evaluator import Evaluator
        from pymoo.problems.static import StaticProblem

        self.best = _better(self.best, self._population.get("X"), fitness)
        judged = StaticProblem(self._algorithm.problem, F=np.minimum(fitness, _LARGEST)[:, None])
        Evaluator().eval(judged, self._population)
        self._algorithm.tell(infills=self._population)


def _better(best: tuple[Array, float], points: Array, fitness: Array) -> tuple[Array, float]:
    least = int(np.argmin(fitness))
    return (points[least].copy(), float(fitness[least])) if fitness[least] < best[1] else best


def _single(problem: PosedProblem) -> Any:
    """The fitness of one point, finite, clipped to the box."""
    box = problem.box

    def judged(point: Array) -> float:
        return float(min(problem.fitness(np.clip(point, box.lower, box.upper)[None])[0], _LARGEST))

    return judged


def _bounds(problem: PosedProblem) -> list[tuple[float, float]]:
    return list(zip(problem.box.lower.tolist(), problem.box.upper.tolist(), strict=True))


def _imported(module: str, package: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        raise InputError(f"the package {package} is not installed; run: pip install {package}") from None


# The methods that come with seatrial: its searches and estimators, and those of packages that it depends on.

RANDOM, OUTPUT_ERROR, IDENTIFY = "random", "output-error", "identify"
"""Names of the trivial baseline and of the package's own estimators."""
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
    method = SEARCH_METHODS[name]
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
            name.value, SEARCH_METHODS[name].source, "", partial(_published_search, name),
            _is_any if name in (EstimateMethod.PSO, EstimateMethod.WHO, EstimateMethod.IWHO) else _is_constant,
        )
        for name in SEARCHES
    ),
    BuiltIn("scipy-de", "SciPy, differential_evolution", "scipy", scipy_evolution, _is_constant),
    BuiltIn("scipy-annealing", "SciPy, dual_annealing", "scipy", scipy_annealing, _is_constant),
    BuiltIn("scipy-nelder-mead", "SciPy, minimize, from the start", "scipy", scipy_simplex, _is_constant),
    BuiltIn("cmaes", "cmaes, CMA", "cmaes", cmaes_search, _is_constant),
    BuiltIn("pymoo-de", "pymoo, DE", "pymoo", pymoo_evolution, _is_constant),
    BuiltIn("pymoo-pso", "pymoo, PSO", "pymoo", pymoo_swarm, _is_constant),
    BuiltIn(OUTPUT_ERROR, "output error by Levenberg-Marquardt from the start", "", _output_error, _has_residuals),
    BuiltIn(IDENTIFY, "seatrial identify, defaults", "", _identify, _has_trial),
)  # fmt: skip


# Methods that are entered against the problems: built-in, installed, or of a user's file or module.

OPTIMISER_GROUP = "seatrial.optimisers"
Estimator = Callable[[PosedProblem, np.random.Generator], Any]
"""Returns values (d,), or values and their covariance (d, d) or None."""


@dataclass(frozen=True, eq=False)
class EnteredMethod:
    """A method under the name by which it was entered.

    Attributes:
        source: where it was published, or the file or module that defines it.
        digest: changes with whatever may change its answers, besides the versions of seatrial and its packages.
        is_built_in: whether it comes with seatrial.
        estimate: problem and random numbers -> answer, as `Estimator`; an optimiser is wrapped.
        suits: whether it can be entered against a problem.
    """

    name: str
    source: str
    digest: str
    is_built_in: bool
    estimate: Estimator
    suits: Callable[[PosedProblem], bool] = lambda _: True


def built_in_methods() -> Mapping[str, EnteredMethod]:
    """Return the methods that come with seatrial, by name; nothing of other packages is imported."""
    entries = ENTRIES
    methods = (EnteredMethod(e.name, e.source, e.digest(), True, e.estimate, e.suits) for e in entries)
    return MappingProxyType({method.name: method for method in methods})


@cache
def method_named(text: str) -> EnteredMethod:
    """Return a method: a built-in or installed one by its name, ``FILE.py``, ``FILE.py:Name`` or ``module:Name``.

    A file or module is executed. Its class has `ask` and `tell` (an optimiser, made from a box and a generator) or
    `estimate` (made without arguments); a function is called as `estimate`.

    Raises:
        InputError: no such name, file or module; it fails; nothing in it is a method, or several are.
    """
    if text in (methods := built_in_methods()):
        return methods[text]
    if text in (names := installed(OPTIMISER_GROUP)):
        package = names[text].dist
        digest = f"{package.name} {package.version}" if package else ""
        return _method(text, load_plugin(OPTIMISER_GROUP, text, InputError), names[text].value, digest)
    place, _, name = text.rpartition(":") if ":" in text[2:] else (text, "", "")  # 2: letters of a drive, C:
    if place.endswith(".py"):
        module = _module_of_file(Path(place))
    elif name:
        module = _module(place)
    else:
        hint = spelling_hint(text, [*methods, *names])
        raise InputError(f"there is no method '{text}'{hint}; or give FILE.py, FILE.py:Name or module:Name")
    return _method(text, _member(module, name, place), text, _source_digest(module))


def entered_method(member: Any) -> EnteredMethod:
    """Return a class or function of this process as a method, to try it; benchmarks take it by its file."""
    return _method(member.__name__, member, f"{member.__module__}:{member.__name__}", "")


def _method(name: str, member: Any, source: str, digest: str) -> EnteredMethod:
    """Return an object of a user as a method."""
    if _is_optimiser(member):
        return EnteredMethod(
            name, source, digest, False, lambda problem, rng: searched(member(problem.box, rng), problem)
        )
    if isinstance(member, type):
        create: Any = member
        return EnteredMethod(name, source, digest, False, lambda problem, rng: create().estimate(problem, rng))
    return EnteredMethod(name, source, digest, False, member)


def _is_optimiser(member: Any) -> bool:
    """Whether it makes optimisers; a factory that is no class states that it returns one."""
    if inspect.isclass(member):
        return issubclass(member, Asking)
    return inspect.isfunction(member) and _is_optimiser(inspect.signature(member).return_annotation)


def _member(module: ModuleType, name: str, place: str) -> Any:
    """Return the method that a module defines."""
    if name:
        if not hasattr(module, name):
            raise InputError(f"'{place}' defines no '{name}'; give one of {_listed(module)}")
        return getattr(module, name)
    names = _method_names(module)
    if len(names) != 1:
        several = f"several methods ({', '.join(names)})" if names else "no class with ask and tell, or with estimate"
        raise InputError(f"'{place}' defines {several}; name one: {place}:Name")
    return getattr(module, names[0])


def _method_names(module: ModuleType) -> list[str]:
    """Return the names of classes with ask and tell or estimate, and of a function `estimate`."""
    local = {n: v for n, v in vars(module).items() if getattr(v, "__module__", "") == module.__name__}
    public = {n: v for n, v in local.items() if not n.startswith("_")}
    classes = [n for n, v in public.items() if inspect.isclass(v) and (_is_optimiser(v) or hasattr(v, "estimate"))]
    return [*classes, *(n for n, v in public.items() if n == "estimate" and inspect.isfunction(v))]


def _listed(module: ModuleType) -> str:
    return ", ".join(_method_names(module)) or "none: it has no class with ask and tell, or with estimate"


def _module_of_file(path: Path) -> ModuleType:
    """Execute a file as a module of its own."""
    if not is_file(path):
        raise InputError(f"method file {path} does not exist; give the path of a Python file")
    name = (
        f"seatrial_method_{path.stem}_{hashlib.sha256(path.read_bytes()).hexdigest()[:16]}"  # 16 digits: no two alike
    )
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up there
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise InputError(f"method file {path} fails: {type(error).__name__}: {error}; correct it") from error
    return module


def _module(name: str) -> ModuleType:
    try:
        return import_module(name)
    except Exception as error:
        raise InputError(f"module '{name}' of the method cannot be imported: {error}; install or correct it") from error


def _source_digest(module: ModuleType) -> str:
    """Return the SHA-256 of a module's file, hexadecimal."""
    file = module.__file__
    return hashlib.sha256(Path(file).read_bytes()).hexdigest() if file else ""
