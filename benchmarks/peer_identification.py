"""Run by the peers' own Python: seconds to 1 % of each package with our fitness, into `peer.npz`.

Usage: python peer_identification.py FOLDER BOXES
"""

import logging
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from cmaes import CMA
from mealpy import SHADE, FloatVar
from pymoo.algorithms.soo.nonconvex.cmaes import CMAES
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from pyswarms.single import GlobalBestPSO
from to_one_percent import TimedFitness, seas_and_boxes, time_to_target

SIZE, POPULATION, GENERATIONS, LIMIT = 8, 40, 5000, 10.0
UNIT = np.stack([np.zeros(SIZE), np.ones(SIZE)])


def pyswarms(judge: TimedFitness, seed: int) -> None:
    """Its global best swarm with Clerc & Kennedy's constriction."""
    np.random.seed(seed)  # noqa: NPY002
    weights = {"w": 0.7298, "c1": 1.49618, "c2": 1.49618}
    GlobalBestPSO(POPULATION, SIZE, weights, (UNIT[0], UNIT[1])).optimize(judge, GENERATIONS, verbose=False)


def mealpy(judge: TimedFitness, seed: int) -> None:
    """L-SHADE; one candidate at a time, as the package asks."""
    problem = {
        "bounds": FloatVar(lb=UNIT[0], ub=UNIT[1]),
        "obj_func": lambda x: float(judge(np.asarray(x)[None])[0]),
        "minmax": "min",
        "log_to": None,
    }
    SHADE.L_SHADE(GENERATIONS, POPULATION).solve(problem, seed=seed)


class BatchProblem(Problem):
    """Populations at once."""

    def __init__(self, judge: TimedFitness) -> None:
        super().__init__(n_var=SIZE, n_obj=1, xl=UNIT[0], xu=UNIT[1])
        self.judge = judge

    def _evaluate(self, x: np.ndarray, out: dict[str, np.ndarray], *_: object, **__: object) -> None:
        out["F"] = self.judge(np.atleast_2d(x))[:, None]


def pymoo_with(make: Callable[[], object]) -> Callable[[TimedFitness, int], None]:
    """One of its algorithms."""

    def search(judge: TimedFitness, seed: int) -> None:
        minimize(BatchProblem(judge), make(), ("n_gen", GENERATIONS), seed=seed, verbose=False)

    return search


def cmaes_of(population: int | None) -> Callable[[TimedFitness, int], None]:
    """From the middle of the box, sigma 0.3 of its width."""

    def search(judge: TimedFitness, seed: int) -> None:
        strategy = CMA(np.full(SIZE, 0.5), 0.3, bounds=UNIT.T, seed=seed, population_size=population)
        while not strategy.should_stop():
            asked = [strategy.ask() for _ in range(strategy.population_size)]
            strategy.tell(list(zip(asked, judge(np.array(asked)).tolist(), strict=True)))

    return search


PEERS: dict[str, Callable[[TimedFitness, int], None]] = {
    "pyswarms global best": pyswarms,
    "mealpy L-SHADE": mealpy,
    "pymoo DE": pymoo_with(lambda: DE(pop_size=POPULATION)),
    "pymoo PSO": pymoo_with(lambda: PSO(pop_size=POPULATION)),
    "pymoo CMA-ES": pymoo_with(lambda: CMAES(x0=np.full(SIZE, 0.5), sigma=0.3)),
    "cmaes, its own population": cmaes_of(None),
    "cmaes, 40": cmaes_of(POPULATION),
}


def main(folder: Path, boxes: int) -> None:
    """All packages in all boxes, after one warm-up each."""
    logging.disable(logging.CRITICAL)
    warnings.simplefilter("ignore")
    drawn = seas_and_boxes(boxes)
    for search in PEERS.values():
        time_to_target(search, *drawn[0], 0, 0.5)
    found = {
        name: np.array([time_to_target(search, *one, k, LIMIT) for k, one in enumerate(drawn)])
        for name, search in PEERS.items()
    }
    np.savez(folder / "peer.npz", **found)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
