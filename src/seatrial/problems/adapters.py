"""Optimisers of other packages as methods; each package is imported when it is used."""

from importlib import import_module
from typing import Any

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.problems.ask_tell import searched
from seatrial.problems.estimate import Estimate
from seatrial.problems.posed import PosedProblem

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
