"""Gains for every speed, heading and height of sea, beside one set for all."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from seatrial.control.gain_evaluation import OUTPUT, GainEvaluator, exceedance_share
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds, refine_gains
from seatrial.control.task import ScheduleGrid, Seaway, TuningTask
from seatrial.core.results.tuning import OperatingPoint
from seatrial.core.values import Array

# Sobol points, refined starts, rounds of random neighbours and neighbours a round; chosen
_SAMPLES, _STARTS, _ROUNDS, _NEIGHBOURS = 4096, 3, 8, 1024


@dataclass(frozen=True, eq=False)
class ScheduleCondition:
    """One speed, heading and height, with the evaluator of its loop: least output variance."""

    U: float
    beta: float
    height: float
    evaluator: GainEvaluator

    def cost(self, gains: Array) -> Array:
        """Return the output rms over that without control, of the gains (n, g); infinite where unstable."""
        return np.sqrt(self.evaluator.evaluate(gains).objectives[:, 0] / self.evaluator.uncontrolled_variance)


def schedule_conditions(task: TuningTask, grid: ScheduleGrid) -> tuple[ScheduleCondition, ...]:
    """Return every combination of the plan; the first seaway of the task gives spectrum, hull and spreading."""
    sea = next(met for met in task.disturbances if isinstance(met, Seaway))
    made = []
    for height, U, beta in product(grid.heights, grid.speeds, grid.headings):
        there = replace(sea, spectrum=sea.spectrum.with_height(height), U=U, beta=beta)
        evaluator = GainEvaluator(replace(task, disturbances=(there,)), task.loop, (OUTPUT,))
        made.append(ScheduleCondition(U, beta, height, evaluator))
    return tuple(made)


def schedule(
    task: TuningTask,
    grid: ScheduleGrid,
    baselines: Mapping[str, Array],
    seed: int,
    report_progress: Callable[[str], None],
) -> tuple[OperatingPoint, ...]:
    """Return the best gains of each condition, and what `baselines` (name -> gains) and one set for all cost there.

    "one for all" has the least mean cost of all sets that keep the restrictions in every condition.
    """
    known = schedule_conditions(task, grid)
    samples = _samples(known[0].evaluator, seed)
    made, best, others = [], [], dict(baselines)
    for i, condition in enumerate(known):
        best.append(_best_gains(condition, samples))
        report_progress(f"schedule: {i + 1} of {len(known)} conditions")
    one = _common_gains(known, samples, np.random.default_rng(seed))
    if one is not None:
        others["one for all"] = one
    for condition, gains in zip(known, best, strict=True):
        judged = condition.evaluator.evaluate(gains[None])
        made.append(OperatingPoint(
            condition.U, condition.beta, condition.height,
            dict(zip(task.loop.gains.names, gains.tolist(), strict=True)),
            float(condition.cost(gains[None])[0]), float(judged.Ms[0]),
            exceedance_share(task.constraints.limit, float(judged.variances[0, 0, 1])),
            {name: float(condition.cost(other[None])[0]) for name, other in others.items()},
            bool(judged.is_feasible[0]),
        ))  # fmt: skip
    return tuple(made)


def _samples(evaluator: GainEvaluator, seed: int) -> Array:
    """Return gains spread over their box, (n, g): Sobol points, half of them towards small gains."""
    from scipy.stats import qmc

    _, (low, high) = free_gain_bounds(evaluator)
    unit = qmc.Sobol(len(low), seed=seed).random(_SAMPLES)
    unit[::2] **= 3.0
    return all_gains(evaluator, low + unit * (high - low))


def _common_gains(conditions: tuple[ScheduleCondition, ...], samples: Array, rng: np.random.Generator) -> Array | None:
    """Return gains (g,) of the least mean cost among those that keep the restrictions everywhere; None without any."""
    places, (low, high) = free_gain_bounds(conditions[0].evaluator)
    best, least, tried = None, math.inf, samples
    for size in np.geomspace(0.1, 0.003, _ROUNDS):  # steps from 10 % down to 0.3 % of each gain's range; chosen
        total = np.mean(
            [np.where(c.evaluator.evaluate(tried).is_feasible, c.cost(tried), np.inf) for c in conditions], axis=0
        )
        place = int(np.argmin(total))
        if total[place] < least:
            best, least = tried[place], float(total[place])
        if best is None:
            return None
        steps = size * (high - low) * rng.standard_normal((_NEIGHBOURS, len(places)))
        tried = all_gains(conditions[0].evaluator, np.clip(best[places] + steps, low, high))
    return best


def _best_gains(condition: ScheduleCondition, samples: Array) -> Array:
    """Return the best samples pressed against the restrictions; the least variance wins, (g,)."""
    judge = condition.evaluator
    judged = judge.evaluate(samples)
    values = np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)
    places = free_gain_bounds(judge)[0]
    if not np.isfinite(values).any():
        return samples[int(np.argmin(judged.excess.max(axis=1)))]

    tried = [samples[i] for i in np.argsort(values)[:_STARTS]]
    tried += [all_gains(judge, refine_gains(judge, start[places])[None])[0] for start in tried]
    judged = judge.evaluate(np.array(tried))
    return tried[int(np.argmin(np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)))]
