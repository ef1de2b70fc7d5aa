"""Gains for every speed, heading and height of sea, smoothed, beside one set for all."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from seatrial.control.controller import shortfall, violated_restrictions
from seatrial.control.gain_evaluation import (
    GainEvaluation,
    GainEvaluator,
    all_gains,
    exceedance_share,
    free_gain_bounds,
    least_output_gains,
    spread_gains,
)
from seatrial.control.task import ScheduleGrid, Seaway, SlowDisturbance, TuningTask
from seatrial.core.results.tuning import OperatingPoint, ScheduleCheck, ScheduleTrade
from seatrial.core.values import Array, Index, InputError, Parameters
from seatrial.physics.loops import TransferLoop

# A schedule whose gains change little from one condition to the next: successive linear programmes.

_FLOOR = 1e-4  # least gain as a share of its range: zero has no logarithm; chosen
_MARGIN = 1e-4  # by which the programme keeps restrictions, for rounding; chosen
_PENALTY = 10.0  # cost of breaking a restriction by its whole; above any gain in cost, which is below one
_TRUST = 0.4, 1e-4  # first and last radius of the trust region, logarithms of gains; chosen
_CEILING_WEIGHT = 0.1  # of a ceiling beside a restriction: those come first; chosen
_ROUNDS = 200  # programmes at most; chosen


@dataclass(frozen=True, eq=False)
class GainGrid:
    """Conditions on a grid.

    Attributes:
        evaluators: of each condition, in the order of the grid, the last axis fastest, (n,).
        shape: of the grid.
        ceilings: largest cost in each condition, infinite where there is none, (n,).
    """

    evaluators: Sequence[GainEvaluator]
    shape: tuple[int, ...]
    ceilings: Array

    @property
    def neighbours(self) -> Index:
        """Return pairs of conditions that differ by one step along one axis, (m, 2)."""
        places = np.arange(math.prod(self.shape)).reshape(self.shape)
        pairs = [
            np.stack([np.delete(places, -1, axis).ravel(), np.delete(places, 0, axis).ravel()], axis=1)
            for axis in range(len(self.shape))
        ]
        return np.concatenate(pairs)

    def costs(self, gains: Array) -> Array:
        """Return the output's rms over that without control in each condition, gains (n, g), (n,)."""
        return np.array([
            math.sqrt(one.evaluate(own[None]).objectives[0, 0] / one.uncontrolled_variance)
            for one, own in zip(self.evaluators, gains, strict=True)
        ])  # fmt: skip

    def excesses(self, gains: Array, costs: Array) -> Array:
        """Return what is exceeded of Ms, actuator, rate and, weighed less, the ceiling, as shares, (n, 4)."""
        limits = np.array([one.evaluate(own[None]).excess[0] for one, own in zip(self.evaluators, gains, strict=True)])
        return np.column_stack([limits, _CEILING_WEIGHT * (costs / self.ceilings - 1.0)])


def smooth_gains(grid: GainGrid, start: Array, largest_step: float) -> Array:
    """Return gains (n, g) of least mean cost, none further from a neighbour's than a share of the larger one.

    start: gains (n, g) that keep the step.
    """
    places, (low, high) = free_gain_bounds(grid.evaluators[0])
    bounds = np.log(np.maximum(low, _FLOOR * (high - low))), np.log(high)
    apart = -math.log1p(-largest_step)

    def gains_of(x: Array) -> Array:
        return all_gains(grid.evaluators[0], np.exp(x))

    def merit(x: Array) -> float:
        costs = grid.costs(gains_of(x))
        if not np.all(np.isfinite(costs)):
            return math.inf
        broken = np.maximum(grid.excesses(gains_of(x), costs), 0.0)
        return float(np.mean(costs) + _PENALTY * np.sum(broken))

    x = np.clip(np.log(np.maximum(start[:, places], np.exp(bounds[0]))), *bounds)
    radius, best, slopes = _TRUST[0], merit(x), _slopes(grid, gains_of(x))
    for _ in range(_ROUNDS):
        tried = x + _programme(grid, slopes, x, bounds, apart, radius)
        value = merit(tried)
        if value < best:
            x, best, radius = tried, value, min(2.0 * radius, _TRUST[0])
            slopes = _slopes(grid, gains_of(x))
            continue
        radius *= 0.5
        if radius < _TRUST[1]:
            break
    return gains_of(x)


def _programme(
    grid: GainGrid, about: tuple[Array, Array, Array], x: Array, bounds: tuple[Array, Array], apart: float,
    radius: float,
) -> Array:  # fmt: skip
    """Return the step (n, f) of the linear programme by the slopes about x (n, f); one slack for each condition."""
    from scipy.optimize import linprog

    n, f = x.shape
    slopes, limits, excesses = about
    # a slack for each condition behind the gains; 81 unknowns for 27 conditions: a dense table does
    restrictions = np.zeros((n, 4, n * f + n))
    for i in range(n):
        restrictions[i, :, i * f : (i + 1) * f] = limits[i]
        restrictions[i, :, n * f + i] = -1.0
    pairs = grid.neighbours
    steps = np.zeros((len(pairs) * f, n * f + n))
    line = np.arange(len(pairs) * f)
    steps[line, (pairs[:, :1] * f + np.arange(f)).ravel()] = 1.0
    steps[line, (pairs[:, 1:] * f + np.arange(f)).ravel()] = -1.0
    gap = (x[pairs[:, 0]] - x[pairs[:, 1]]).ravel()
    done = linprog(
        np.concatenate([slopes.ravel() / n, np.full(n, _PENALTY)]),
        A_ub=np.concatenate([restrictions.reshape(4 * n, -1), steps, -steps]),
        b_ub=np.concatenate([-excesses.ravel() - _MARGIN, apart - gap, apart + gap]),
        bounds=[
            *zip(
                np.maximum(-radius, bounds[0] - x).ravel(), np.minimum(radius, bounds[1] - x).ravel(), strict=True
            ),
            *[(0.0, None)] * n,
        ],
        method="highs",
        options={"presolve": False},  # of so few unknowns it takes longer than it saves
    )  # fmt: skip
    return done.x[: n * f].reshape(n, f) if done.x is not None else np.zeros_like(x)


def _slopes(grid: GainGrid, gains: Array) -> tuple[Array, Array, Array]:
    """Return derivatives of costs (n, f) and excesses (n, 4, f) by logarithms of gains, and the excesses (n, 4)."""
    places = free_gain_bounds(grid.evaluators[0])[0]
    costs = grid.costs(gains)
    of_costs, of_limits = [], []
    for one, own, cost in zip(grid.evaluators, gains, costs, strict=True):
        objectives, excess = one.point(own).slopes
        of_costs.append((0.5 / (cost * one.uncontrolled_variance)) * objectives[0, places] * own[places])
        of_limits.append(excess[:, places] * own[places])
    slopes = np.array(of_costs)
    limits = np.concatenate([np.array(of_limits), _CEILING_WEIGHT * (slopes / grid.ceilings[:, None])[:, None]], axis=1)
    return slopes, limits, grid.excesses(gains, costs)


def midpoints(values: Sequence[float]) -> tuple[float, ...]:
    """Return values with the middle of each two neighbours between them."""
    between = [0.5 * (a + b) for a, b in pairwise(values)]
    return tuple(sorted([*values, *between]))


# A schedule's gains between its conditions, and where its conditions end.

_ALONE = 0.1  # share of the only value of an axis within which it holds; chosen


@dataclass(frozen=True, eq=False)
class GainSchedule:
    """Gains on a grid of speed, heading and height.

    Attributes:
        names: of the gains; axes: speeds [m/s], headings [rad] and significant heights [m], each rising.
        gains: (speeds, headings, heights, g).
    """

    names: tuple[str, ...]
    axes: tuple[Array, Array, Array]
    gains: Array

    def holds(self, conditions: Array) -> NDArray[np.bool_]:
        """Return which conditions (n, 3) of speed, heading and height lie within the schedule, (n, 3)."""
        limits = [self.limits(k) for k in range(len(self.axes))]
        low, high = np.array(limits).T
        return (conditions >= low) & (conditions <= high)

    def limits(self, axis: int) -> tuple[float, float]:
        """Return the ends of an axis; of one value a tenth to either side."""
        first, last = float(self.axes[axis][0]), float(self.axes[axis][-1])
        return (first, last) if last > first else (first * (1.0 - _ALONE), first * (1.0 + _ALONE))

    def gains_at(self, conditions: Array) -> Array:
        """Return gains (n, g), linear between conditions, at conditions (n, 3) within the schedule."""
        from scipy.interpolate import RegularGridInterpolator

        several = [k for k, axis in enumerate(self.axes) if len(axis) > 1]
        if not several:
            return np.tile(self.gains.reshape(1, -1), (len(conditions), 1))
        table = self.gains.reshape(*(len(self.axes[k]) for k in several), -1)
        return np.asarray(RegularGridInterpolator([self.axes[k] for k in several], table)(conditions[:, several]))


def gain_schedule(points: Sequence[OperatingPoint], names: tuple[str, ...]) -> GainSchedule:
    """Return the schedule of a tuning's points, its gains in the order of `names`.

    Raises:
        InputError: there are none, gains of other names in some, or not one point for every combination.
    """
    if not points:
        raise InputError("there is no schedule: add [schedule] to the loop file and run 'seatrial tune' again")
    if any(set(point.gains) != set(names) for point in points):
        raise InputError("the points of the schedule have different gains; run 'seatrial tune' again")
    conditions = np.array([(point.U, point.beta, point.height) for point in points])
    axes, places = zip(*(np.unique(column, return_inverse=True) for column in conditions.T), strict=True)
    shape = tuple(len(axis) for axis in axes)
    gains = np.full((*shape, len(names)), np.nan)
    gains[places] = [[point.gains[name] for name in names] for point in points]
    if np.prod(shape) != len(points) or not np.all(np.isfinite(gains)):
        raise InputError(
            f"the schedule has {len(points)} points for {' x '.join(map(str, shape))} conditions of speed, heading and "
            "height; give one for every combination"
        )
    return GainSchedule(names, (axes[0], axes[1], axes[2]), gains)


# Gains for every speed, heading and height of sea, beside one set for all.

# rounds of random neighbours and neighbours a round; chosen
_SEARCH_ROUNDS, _NEIGHBOURS = 8, 1024
_RATE_SHARES = (0.7, 0.5, 0.35, 0.25, 0.18)  # of the rate that the least output takes, tried for a demand; chosen
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
    """Return every combination of the plan, each with the plant, demand and slow disturbances at its speed.

    The first seaway of the task gives spectrum, hull and spreading; where it does not reach the loop (a heading from
    abeam) the slow disturbances alone are met.
    """
    tasks = {U: task if task.at_speed is None else task.at_speed(U) for U in grid.speeds}
    bounds = _joint_bounds([one.loop.gains for one in tasks.values()])
    made = []
    for height, U, beta in product(grid.heights, grid.speeds, grid.headings):
        there = tasks[U]
        loop = replace(
            task.loop, plant=there.loop.plant, disturbance=there.loop.disturbance, points=there.loop.points,
            gains=bounds,
        )  # fmt: skip
        sea = next(met for met in there.disturbances if isinstance(met, Seaway))
        sea = replace(sea, spectrum=sea.spectrum.with_height(height), U=U, beta=beta)
        slow = tuple(met for met in there.disturbances if isinstance(met, SlowDisturbance) and task.demand is not None)
        met = (sea, *slow) if _reaches(sea, loop) or not slow else slow
        evaluator = GainEvaluator(replace(there, loop=loop, disturbances=met), loop, (task.motion,))
        made.append(ScheduleCondition(U, beta, height, evaluator))
    return tuple(made)


def _reaches(sea: Seaway, loop: TransferLoop) -> bool:
    """Return whether a sea moves the loop at all."""
    try:
        sea.exposure(sea.disturbed(loop))
    except InputError:
        return False
    return True


def _joint_bounds(gains: Sequence[Parameters]) -> Parameters:
    """Return gains whose bounds hold those of all speeds: one schedule is searched within one box."""
    rows = zip(*gains, strict=True)
    return Parameters(
        tuple(
            replace(row[0], lower=min(one.lower for one in row), upper=max(one.upper for one in row))
            if row[0].free
            else row[0]
            for row in rows
        )
    )


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
    there = task.at_speed or (lambda _: task)
    starts = [there(U).loop.gain_values for U in grid.speeds]
    samples = np.concatenate([spread_gains(conditions[0].evaluator, seed), starts, *([g] for g in baselines.values())])
    alone: list[Array] = []
    for i, condition in enumerate(conditions):
        near = [alone[i - step] for step in (1, len(grid.headings)) if i >= step]
        alone.append(_own_gains(condition.evaluator, samples, near))
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
    return Schedule(points, tuple(trades), _check_between(task, grid, points))


def _own_gains(evaluator: GainEvaluator, samples: Array, near: Sequence[Array]) -> Array:
    """Return the gains of a condition alone (g,): of the least output, and where a demand is followed, that follow it.

    The actuator's rate is lowered until the demand is kept; where it never is, the gains that come nearest. near: those
    of neighbouring conditions, which are followed to this one.
    """
    best = least_output_gains(evaluator, samples, near)
    if evaluator.task.demand is None:
        return best
    used = float(evaluator.evaluate(best[None]).variances[0, :, 2].max())
    tried = [best]
    for share in _RATE_SHARES:
        if shortfall(evaluator.task, evaluator.loop, tried[-1], draws=0)[0] == 0.0 or not math.isfinite(used):
            return tried[-1]
        # the share exp(-1/2) of a Rayleigh distribution lies beyond its rms
        within = replace(
            evaluator.task.constraints, rate=share * math.sqrt(used), rate_saturation=math.exp(-0.5)
        )  # fmt: skip
        slower = evaluator.within(within)
        tried.append(least_output_gains(slower, np.concatenate([samples, tried])))
    return min(tried, key=lambda gains: shortfall(evaluator.task, evaluator.loop, gains, draws=0)[0])


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
        lacks = _lacks(condition.evaluator, judged, own)
        made.append(OperatingPoint(
            condition.U, condition.beta, condition.height,
            dict(zip(task.loop.gains.names, own.tolist(), strict=True)),
            float(condition.cost(own[None])[0]), float(judged.Ms[0]),
            exceedance_share(task.constraints.limit, float(judged.variances[0, :, 1].max())),
            {name: float(condition.cost(other[i][None])[0]) for name, other in compared.items()},
            not lacks, lacks,
        ))  # fmt: skip
    return tuple(made)


def _lacks(evaluator: GainEvaluator, judged: GainEvaluation, gains: Array) -> tuple[str, ...]:
    """Return what the gains (g,) do not keep in a condition: restrictions, and the demand as it is simulated there."""
    broken = violated_restrictions(evaluator, judged)
    if evaluator.task.demand is None or not math.isfinite(judged.Ms[0]):
        return broken
    short = shortfall(evaluator.task, evaluator.loop, gains, draws=0)[1]
    return (*broken, short) if short else broken


def _check_between(task: TuningTask, grid: ScheduleGrid, points: Sequence[OperatingPoint]) -> ScheduleCheck:
    """Return how interpolated gains keep the restrictions on the grid with its midpoints."""
    fine = replace(grid, speeds=midpoints(grid.speeds), headings=midpoints(grid.headings),
                   heights=midpoints(grid.heights))  # fmt: skip
    conditions = schedule_conditions(task, fine)
    between = gain_schedule(points, task.loop.gains.names).gains_at(
        np.array([(one.U, one.beta, one.height) for one in conditions])
    )
    judged = [one.evaluator.evaluate(own[None]) for one, own in zip(conditions, between, strict=True)]
    return ScheduleCheck(len(judged), sum(bool(j.is_feasible[0]) for j in judged), max(float(j.Ms[0]) for j in judged))


def _common_gains(conditions: tuple[ScheduleCondition, ...], samples: Array, rng: np.random.Generator) -> Array | None:
    """Return gains (g,) of the least mean cost among those that keep the restrictions everywhere; None without any."""
    places, (low, high) = free_gain_bounds(conditions[0].evaluator)
    best, least, tried = None, math.inf, samples
    # steps from 10 % down to 0.3 % of each gain's range; chosen
    for size in np.geomspace(0.1, 0.003, _SEARCH_ROUNDS):
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
