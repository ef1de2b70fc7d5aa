"""A schedule whose gains change little from one condition to the next: successive linear programmes.

Griffith & Stewart 1961 (Management Science 7, 379-392): costs and restrictions are made linear about the gains at hand,
the programme is solved within a trust region, and a step is taken where the true cost falls. Unknowns are logarithms of
the gains, so that a largest step is a share of the larger of two neighbouring gains.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds
from seatrial.core.values import Array, Index

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
    radius, best = _TRUST[0], merit(x)
    for _ in range(_ROUNDS):
        tried = x + _programme(grid, gains_of(x), x, bounds, apart, radius)
        value = merit(tried)
        if value < best:
            x, best, radius = tried, value, min(2.0 * radius, _TRUST[0])
            continue
        radius *= 0.5
        if radius < _TRUST[1]:
            break
    return gains_of(x)


def _programme(
    grid: GainGrid, gains: Array, x: Array, bounds: tuple[Array, Array], apart: float, radius: float
) -> Array:
    """Return the step (n, f) of the linear programme about the gains; one slack for each condition."""
    from scipy.optimize import linprog

    n, f = x.shape
    slopes, limits, excesses = _slopes(grid, gains)
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
    )  # fmt: skip
    return done.x[: n * f].reshape(n, f) if done.x is not None else np.zeros_like(x)


def _slopes(grid: GainGrid, gains: Array) -> tuple[Array, Array, Array]:
    """Return derivatives of costs (n, f) and excesses (n, 4, f) by logarithms of gains, and the excesses (n, 4)."""
    places = free_gain_bounds(grid.evaluators[0])[0]
    costs = grid.costs(gains)
    of_costs, of_limits = [], []
    for one, own, cost in zip(grid.evaluators, gains, costs, strict=True):
        objectives, excess = one.slopes(own)
        of_costs.append((0.5 / (cost * one.uncontrolled_variance)) * objectives[0, places] * own[places])
        of_limits.append(excess[:, places] * own[places])
    slopes = np.array(of_costs)
    limits = np.concatenate([np.array(of_limits), _CEILING_WEIGHT * (slopes / grid.ceilings[:, None])[:, None]], axis=1)
    return slopes, limits, grid.excesses(gains, costs)


def midpoints(values: Sequence[float]) -> tuple[float, ...]:
    """Return values with the middle of each two neighbours between them."""
    between = [0.5 * (a + b) for a, b in pairwise(values)]
    return tuple(sorted([*values, *between]))


def interpolated_gains(shape: tuple[int, ...], gains: Array) -> Array:
    """Return gains (m, g) on the grid with midpoints along every axis, straight between conditions; gains: (n, g)."""
    table = gains.reshape(*shape, -1)
    for axis in range(len(shape)):
        middle = 0.5 * (np.delete(table, -1, axis) + np.delete(table, 0, axis))
        size = table.shape[axis] + middle.shape[axis]
        made = np.empty((*table.shape[:axis], size, *table.shape[axis + 1 :]))
        even: list[slice] = [slice(None)] * made.ndim
        odd = list(even)
        even[axis], odd[axis] = slice(0, None, 2), slice(1, None, 2)
        made[tuple(even)], made[tuple(odd)] = table, middle
        table = made
    return table.reshape(-1, gains.shape[1])
