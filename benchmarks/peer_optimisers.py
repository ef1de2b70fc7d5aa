"""Run by the peers' own Python: pyswarms and mealpy on the same functions, values and seconds into `peer.npz`.

Usage: python peer_optimisers.py FOLDER
"""

import logging
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mealpy import PSO as MEALPY_PSO
from mealpy import FloatVar
from optimiser_functions import FUNCTIONS, ITERATIONS, LOWER, POPULATION, PSO, RUNS, UPPER
from pyswarms.single import GlobalBestPSO

Function = Callable[[np.ndarray], np.ndarray]


def pyswarms(function: Function, seed: int) -> float:
    """Velocity kept within the box's width, as ours; reflected at walls, as with `nearest` swarms stick to them."""
    np.random.seed(seed)  # noqa: NPY002
    width = UPPER - LOWER
    swarm = GlobalBestPSO(POPULATION, 8, PSO, (LOWER, UPPER), bh_strategy="reflective", velocity_clamp=(-width, width))
    return float(swarm.optimize(function, ITERATIONS, verbose=False)[0])


def mealpy(function: Function, seed: int) -> float:
    """Its particles move only where they gain, and are drawn anew where they leave the box."""
    problem = {
        "bounds": FloatVar(lb=LOWER, ub=UPPER),
        "obj_func": lambda x: float(function(x[None])[0]),
        "minmax": "min",
        "log_to": None,
    }
    model = MEALPY_PSO.OriginalPSO(ITERATIONS - 1, POPULATION, **PSO)
    return float(model.solve(problem, seed=seed).target.fitness)


def main(folder: Path) -> None:
    """Values reached, shape (functions, runs), and seconds of all runs, for each package."""
    logging.disable(logging.CRITICAL)
    out: dict[str, np.ndarray] = {}
    for peer in (pyswarms, mealpy):
        began = time.perf_counter()
        out[peer.__name__] = np.array([[peer(f, s) for s in range(RUNS)] for f in FUNCTIONS.values()])
        out[f"{peer.__name__}_seconds"] = np.array(time.perf_counter() - began)
    np.savez(folder / "peer.npz", **out)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
