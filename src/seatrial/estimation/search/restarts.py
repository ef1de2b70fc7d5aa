"""One search with random numbers of its own, as often as it is repeated."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.search.fitness import Fitness
from seatrial.numerics.optimise import Box, Optimiser, Solution, search

AnyOptimiser = TypeVar("AnyOptimiser", bound=Optimiser)


@dataclass(frozen=True, eq=False)
class FinishedSearch:
    """What one search found.

    Attributes:
        trace: best point after each iteration, (iterations, unknowns).
        cpu_s: processor time of the search [s].
    """

    solution: Solution
    trace: Array
    cpu_s: float


def run_search(
    box: Box,
    create: Callable[[Box, np.random.Generator], AnyOptimiser],
    fitness_of: Callable[[AnyOptimiser], Fitness],
    seed: int,
    restart: int,
    report_progress: Callable[[int, float], None] | None = None,
) -> FinishedSearch:
    """Return one search of a box; its random numbers come from the seed and the number of the restart alone.

    Args:
        create: makes the optimiser.
        fitness_of: makes the fitness, which may change with the optimiser's iteration.
        report_progress: called after each iteration with the number of evaluations and the best fitness.

    Raises:
        SearchError: a fitness that the optimiser cannot take.
    """
    optimiser = create(box, np.random.default_rng([seed, restart]))
    began = time.process_time()
    solution = search(optimiser, fitness_of(optimiser), report_progress)
    return FinishedSearch(solution, optimiser.trace, time.process_time() - began)
