"""Gains for every speed, heading and height of sea, beside one set for all."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluation, GainEvaluator, exceedance_share
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds
from seatrial.control.least_output import least_output_gains, spread_gains
from seatrial.control.smooth_schedule import GainGrid, interpolated_gains, midpoints, smooth_gains
from seatrial.control.task import ScheduleGrid, Seaway, TuningTask
from seatrial.core.results.tuning import OperatingPoint, ScheduleCheck, ScheduleTrade
from seatrial.core.values import Array

# rounds of random neighbours and neighbours a round; chosen
_ROUNDS, _NEIGHBOURS = 8, 1024
_STEPS = (0.1, 0.2, 0.3, 0.5)  # largest steps whose cost is printed; chosen


@dataclass(frozen=True, eq=False)
class ScheduleCondition:
    """One speed, heading and height, with the evaluator of its loop: least output variance."""

    U: float
    beta: float
    height: float
    evaluator: GainEvaluator

    def cost(self, gains: Array) -> Array:
        """Return the output rms over that without control, of the gains (n, g); infinite where unstable."""
        return self.cost_of(self.evaluator.evaluate(gains))

    def cost_of(self, evaluated: GainEvaluation) -> Array:
        """Return the same of gains that the condition's evaluator evaluated."""
        return np.sqrt(evaluated.objectives[:, 0] / self.evaluator.uncontrolled_variance)


def schedule_conditions(task: TuningTask, grid: ScheduleGrid) -> tuple[ScheduleCondition, ...]:
    """Return every combination of the plan; the first seaway of the task gives spectrum, hull and spreading."""
    sea = next(met for met in task.disturbances if isinstance(met, Seaway))
    made = []
    for height, U, beta in product(grid.heights, grid.speeds, grid.headings):
        there = replace(sea, spectrum=sea.spectrum.with_height(height), U=U, beta=beta)
        evaluator = GainEvaluator(replace(task, disturbances=(there,)), task.loop, (task.motion,))
        made.append(ScheduleCondition(U, beta, height, evaluator))
    return tuple(made)


@dataclass(frozen=True, eq=False)
class Schedule:
    """Gains of every condition, what smoothness costs, and the check between conditions."""

    points: tuple[OperatingPoint, ...] = ()
    trades: tuple[ScheduleTrade, ...] = ()
    check: ScheduleCheck | None = None


def schedule(
    task: TuningTask,
    grid: ScheduleGrid,
    baselines: Mapping[str, Array],
    seed: int,
    report_progress: Callable[[str], None],
) -> Schedule:
    """Return smooth gains over the conditions, and what `baselines` (name -> gains) and others cost there.

    "each its own" are the gains of least cost in each condition alone, "one for all" the set of least mean cost that
    keeps the restrictions in every condition; without such a set there is nothing to smooth from, and the schedule is
    "each its own". As far as the largest step allows, no condition costs more than with a baseline that keeps the
    restrictions there.
    """
    conditions = schedule_conditions(task, grid)
    samples = spread_gains(conditions[0].evaluator, seed)
    alone = []
    for i, condition in enumerate(conditions):
        alone.append(least_output_gains(condition.evaluator, samples))
        report_progress(f"schedule: {i + 1} of {len(conditions)} conditions")
    best = np.array(alone)
    compared = {name: np.tile(gains, (len(conditions), 1)) for name, gains in baselines.items()}
    one = _common_gains(conditions, samples, np.random.default_rng(seed))
    if one is None:
        return Schedule(_operating_points(task, conditions, best, compared))
    shape = (len(grid.heights), len(grid.speeds), len(grid.headings))
    evaluators = [c.evaluator for c in conditions]
    gain_grid = GainGrid(evaluators, shape, _ceilings(conditions, compared))
    gains = start = np.tile(one, (len(conditions), 1))
    trades = [ScheduleTrade(0.0, float(np.mean(gain_grid.costs(start))))]
    for step in sorted({*_STEPS, grid.largest_step}):
        start = smooth_gains(gain_grid, start, step)
        trades.append(ScheduleTrade(step, float(np.mean(gain_grid.costs(start)))))
        gains = start if step == grid.largest_step else gains
        report_progress(f"schedule: steps of {100.0 * step:.0f} % at most")
    trades.append(ScheduleTrade(math.inf, float(np.mean(gain_grid.costs(best)))))
    compared |= {"each its own": best, "one for all": np.tile(one, (len(conditions), 1))}
    points = _operating_points(task, conditions, gains, compared)
    return Schedule(points, tuple(trades), _check_between(task, grid, shape, gains))


def _ceilings(conditions: Sequence[ScheduleCondition], baselines: Mapping[str, Array]) -> Array:
    """Return the least cost of baselines (name -> gains (n, g)) that keep the restrictions, (n,); else infinity."""
    made = np.full(len(conditions), np.inf)
    for gains in baselines.values():
        for i, (condition, own) in enumerate(zip(conditions, gains, strict=True)):
            if condition.evaluator.evaluate(own[None]).is_feasible[0]:
                made[i] = min(made[i], float(condition.cost(own[None])[0]))
    return made


def _operating_points(
    task: TuningTask, conditions: Sequence[ScheduleCondition], gains: Array, compared: Mapping[str, Array]
) -> tuple[OperatingPoint, ...]:
    """Return the points of gains (n, g), with what those compared (name -> (n, g)) cost there."""
    made = []
    for i, (condition, own) in enumerate(zip(conditions, gains, strict=True)):
        judged = condition.evaluator.evaluate(own[None])
        made.append(OperatingPoint(
            condition.U, condition.beta, condition.height,
            dict(zip(task.loop.gains.names, own.tolist(), strict=True)),
            float(condition.cost(own[None])[0]), float(judged.Ms[0]),
            exceedance_share(task.constraints.limit, float(judged.variances[0, 0, 1])),
            {name: float(condition.cost(other[i][None])[0]) for name, other in compared.items()},
            bool(judged.is_feasible[0]),
        ))  # fmt: skip
    return tuple(made)


def _check_between(task: TuningTask, grid: ScheduleGrid, shape: tuple[int, ...], gains: Array) -> ScheduleCheck:
    """Return how interpolated gains keep the restrictions on the grid with its midpoints."""
    fine = replace(grid, speeds=midpoints(grid.speeds), headings=midpoints(grid.headings),
                   heights=midpoints(grid.heights))  # fmt: skip
    between = interpolated_gains(shape, gains)
    judged = [c.evaluator.evaluate(own[None]) for c, own in
              zip(schedule_conditions(task, fine), between, strict=True)]  # fmt: skip
    return ScheduleCheck(len(judged), sum(bool(j.is_feasible[0]) for j in judged), max(float(j.Ms[0]) for j in judged))


def _common_gains(conditions: tuple[ScheduleCondition, ...], samples: Array, rng: np.random.Generator) -> Array | None:
    """Return gains (g,) of the least mean cost among those that keep the restrictions everywhere; None without any."""
    places, (low, high) = free_gain_bounds(conditions[0].evaluator)
    best, least, tried = None, math.inf, samples
    for size in np.geomspace(0.1, 0.003, _ROUNDS):  # steps from 10 % down to 0.3 % of each gain's range; chosen
        judged = [(c, c.evaluator.evaluate(tried)) for c in conditions]
        total = np.mean([np.where(made.is_feasible, c.cost_of(made), np.inf) for c, made in judged], axis=0)
        place = int(np.argmin(total))
        if total[place] < least:
            best, least = tried[place], float(total[place])
        if best is None:
            return None
        steps = size * (high - low) * rng.standard_normal((_NEIGHBOURS, len(places)))
        tried = all_gains(conditions[0].evaluator, np.clip(best[places] + steps, low, high))
    return best
