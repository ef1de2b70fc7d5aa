"""The published genetic algorithm compared with the package's own front: answer as a choice, cost and scatter."""

from dataclasses import dataclass, fields
from enum import Enum

import numpy as np

from seatrial.control.gain_choice import GainChoice
from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.genetic import SOURCE, GeneticRun, genetic_runs, searched_objectives
from seatrial.control.genetic_settings import GeneticTuning
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds
from seatrial.control.record_cost import record_cost
from seatrial.core.results.tuning import GainSearch, ParetoFront
from seatrial.core.values import Array
from seatrial.numerics.optimise import hypervolume, non_dominated

FRONT_NAME = "the genetic algorithm"
OWN_CHOICE = "own front"


@dataclass(frozen=True, eq=False)
class PublishedSearch:
    """The answer as a choice of gains, the search in numbers, and what it saw of the front."""

    choice: GainChoice
    result: GainSearch
    front: ParetoFront


def published_search(
    evaluator: GainEvaluator, settings: GeneticTuning, package_front: ParetoFront, seed: int
) -> PublishedSearch:
    """Run the published search on the loop of `evaluator` and compare it with the package's front of that loop.

    Raises:
        InputError: as `genetic_runs`.
    """
    runs = genetic_runs(evaluator, settings, seed)
    answers = all_gains(evaluator, np.stack([run.gains for run in runs]))
    front = _searched_front(evaluator, runs[0])
    result = _search_result(evaluator, settings, runs, answers, package_front, front, seed)
    choice = GainChoice(evaluator, answers[0], FRONT_NAME, _reasons(result))
    return PublishedSearch(choice, result, front)


def _search_result(
    evaluator: GainEvaluator,
    settings: GeneticTuning,
    runs: tuple[GeneticRun, ...],
    answers: Array,
    package_front: ParetoFront,
    front: ParetoFront,
    seed: int,
) -> GainSearch:
    judged, (low, high) = evaluator.evaluate(answers), free_gain_bounds(evaluator)[1]
    beaten = (package_front.objectives[:, None] < judged.objectives).all(axis=2).any(axis=0)
    cost = record_cost(evaluator.loop, answers[0], seed)
    return GainSearch(
        source=SOURCE,
        settings={field.name: _setting_text(getattr(settings, field.name)) for field in fields(settings)},
        objectives={one.name: one.unit for one in searched_objectives(evaluator, settings)},
        evaluations=runs[0].evaluations,
        cpu_s=float(np.median([run.cpu_s for run in runs])),
        histories=np.array([run.history for run in runs]),
        gain_names=evaluator.loop.gains.free_names,
        gains=np.stack([run.gains for run in runs]),
        lower=low,
        upper=high,
        spread=np.ptp([run.gains for run in runs], axis=0) / (high - low),
        values=judged.objectives,
        Ms=judged.Ms,
        is_feasible=tuple(judged.is_feasible.tolist()),
        dominated=int(beaten.sum()),
        hypervolume=_covered_share(front.objectives, package_front.objectives),
        compiled_record_s=cost.compiled,
        lsim_record_s=cost.lsim,
    )


def _searched_front(evaluator: GainEvaluator, run: GeneticRun) -> ParetoFront:
    """Return what one search saw of the front in the task's objectives, restrictions kept."""
    seen = all_gains(evaluator, run.front.points)
    judged = evaluator.evaluate(seen)
    feasible = np.flatnonzero(judged.is_feasible)
    rows = feasible[non_dominated(judged.objectives[feasible])]
    return ParetoFront(
        FRONT_NAME, evaluator.loop.gains.names, seen[rows], judged.objectives[rows], judged.Ms[rows], run.evaluations,
        cpu_s=run.cpu_s,
    )  # fmt: skip


def _covered_share(objectives: Array, reference: Array) -> float:
    """Return hypervolume of objectives (k, m) over that of a reference front (n, m), both up to the latter's nadir."""
    live = np.ptp(reference, axis=0) > 0.0
    if not live.any():
        return float("nan")
    nadir = reference[:, live].max(axis=0)
    within = objectives[:, live][(objectives[:, live] < nadir).all(axis=1)]
    return hypervolume(within, nadir) / hypervolume(reference[:, live], nadir) if len(within) else 0.0


def _setting_text(value: object) -> str:
    return str(value.value if isinstance(value, Enum) else value)


def _reasons(result: GainSearch) -> tuple[str, ...]:
    seeds, spread = len(result.gains), ", ".join(f"{100.0 * share:.0f}" for share in result.spread)
    return (
        "It is the answer of the genetic algorithm of Yu et al. 2014: the fittest of the last generation under equal "
        f"weights of {', '.join(result.objectives)}. The search knows no restriction but stability.",
        f"Over {seeds} seeds its answers spread over {spread} % of the ranges of {', '.join(result.gain_names)}, Ms "
        f"{result.Ms.min():.3g} to {result.Ms.max():.3g}; {result.feasible_count} of {seeds} keep the limits, "
        f"{result.dominated} are beaten in every objective by a controller of the package's front.",
    )
