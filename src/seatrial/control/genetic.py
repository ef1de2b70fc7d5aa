"""The published search for gains (Yu et al. 2014, section 3) on a task: a genetic algorithm with random weights.

It knows no restriction but stability. Its answer is the fittest of the last generation under equal weights.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.genetic_settings import GeneticTuning, SearchedObjectives
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds
from seatrial.core.values import Array, InputError
from seatrial.numerics.optimise import Box, GeneticSettings, NonDominatedSet, RandomWeightGenetic, SearchError
from seatrial.physics.loops import LoopSignal, Objective, squared_deviation, variance

SOURCE = "Yu et al. 2014, CAAI Transactions on Intelligent Systems 9(4), section 3"


@dataclass(frozen=True, eq=False)
class GeneticRun:
    """One search.

    Attributes:
        gains: free gains of the answer (f,); J: its mean of normalised objectives, infinite where nothing was stable.
        history: J after each generation.
        front: points that no evaluated one beats in the objectives searched.
        cpu_s: CPU time with the front.
    """

    gains: Array
    J: float
    history: tuple[float, ...]
    front: NonDominatedSet
    evaluations: int
    cpu_s: float


def genetic_run(
    objective_values: Callable[[Array], Array], box: Box, settings: GeneticSettings, generator: np.random.Generator
) -> GeneticRun:
    """Run one search; `objective_values` takes gains (n, f) and gives objectives (n, m), infinite where unstable."""
    began = time.process_time()
    search, evaluations = RandomWeightGenetic(box, generator, settings), 0
    while not search.done:
        points = search.ask()
        search.tell(objective_values(points))
        evaluations += len(points)
    front = search.front
    gains, J = search.best
    return GeneticRun(gains, J, search.history, front, evaluations, time.process_time() - began)


def genetic_runs(evaluator: GainEvaluator, settings: GeneticTuning, seed: int) -> tuple[GeneticRun, ...]:
    """Run one search for each of the settings' seeds over the free gains of the evaluator's loop.

    Raises:
        InputError: the print's second objective needs a limit of the actuator, too few individuals, or no search met
            a stable loop.
    """
    searched = replace(evaluator, objectives=searched_objectives(evaluator, settings))
    box = Box(*free_gain_bounds(evaluator)[1])
    try:
        algorithm = settings.algorithm_settings(len(searched.objectives))
    except SearchError as error:
        raise InputError(f"genetic: {error}") from None

    def objective_values(free: Array) -> Array:
        return searched.objective_values(all_gains(evaluator, free))

    runs = tuple(
        genetic_run(objective_values, box, algorithm, np.random.default_rng([seed, k])) for k in range(settings.seeds)
    )
    unstable = [k for k, run in enumerate(runs) if not np.isfinite(run.J)]
    if unstable:
        raise InputError(
            f"genetic: search {unstable[0] + 1} of {len(runs)} met no stable loop in {runs[0].evaluations} "
            "controllers; narrow the bounds of the gains, or give it more generations"
        )
    return runs


def searched_objectives(evaluator: GainEvaluator, settings: GeneticTuning) -> tuple[Objective, ...]:
    """Return what the settings say is to be made small.

    Raises:
        InputError: as printed, where the actuator has no limit.
    """
    if settings.objectives is SearchedObjectives.OWN:
        return evaluator.objectives
    target = float(evaluator.allowed_variances[0])
    if not np.isfinite(target):
        raise InputError(
            "genetic: the published objective of the actuator needs its limit; give [actuator] limit, or "
            'set objectives = "minimise" in [genetic]'
        )
    one_sided = settings.objectives is SearchedObjectives.ONE_SIDED
    return (
        variance("J1", "rad^2", LoopSignal.OUTPUT),
        squared_deviation("J2", LoopSignal.ACTUATOR, target, one_sided=one_sided),
        variance("J3", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
    )
