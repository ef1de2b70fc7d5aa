"""One set of gains pressed against what it must keep, by exact gradients."""

import math

import numpy as np
from scipy.optimize import NonlinearConstraint, minimize

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.core.values import Array, Index

GainBounds = tuple[Array, Array]
# in the place of infinity; least value whose logarithm is taken; share of a range that is rounding; largest share by
# which a restriction is exceeded that the search sees
_HUGE, _TINY, _ROUNDING, _LARGEST_EXCESS = 1e30, 1e-300, 1e-12, 1e3


def free_gain_bounds(evaluator: GainEvaluator) -> tuple[Index, GainBounds]:
    """Return the indices of the free gains and their bounds."""
    gains = evaluator.loop.gains
    places = np.array([i for i, p in enumerate(gains) if p.free], dtype=np.int64)
    return places, (np.array([gains.items[i].lower for i in places]), np.array([gains.items[i].upper for i in places]))


def all_gains(evaluator: GainEvaluator, free: Array) -> Array:
    """Return all gains (n, g) of free ones (n, f); the others as the loop has them."""
    made = np.tile(evaluator.loop.gain_values, (len(free), 1))
    made[:, free_gain_bounds(evaluator)[0]] = free
    return made


def refine_gains(evaluator: GainEvaluator, start: Array, ceiling: Array | None = None) -> Array:
    """Return free gains (f,) of the least product of objectives, none above its `ceiling` (m,), restrictions kept.

    SLSQP (Kraft 1988) from feasible free gains, in the unit box, on logarithms of the objectives.
    """
    places, (low, high) = free_gain_bounds(evaluator)
    width = high - low
    count = 0 if ceiling is None else len(ceiling)
    top = np.ones(0) if ceiling is None else np.maximum(ceiling, _TINY)

    def all_gains_at(unit: Array) -> Array:
        return all_gains(evaluator, (low + np.clip(unit, 0.0, 1.0) * width)[None])

    def value(unit: Array) -> float:
        return float(np.sum(np.log(np.clip(evaluator.evaluate(all_gains_at(unit)).objectives[0], _TINY, _HUGE))))

    def slope(unit: Array) -> Array:
        made = evaluator.evaluate(all_gains_at(unit)).objectives[0]
        if not np.all(np.isfinite(made) & (made > 0.0)):
            return np.zeros(len(unit))
        return (evaluator.slopes(all_gains_at(unit)[0])[0][:, places] / made[:, None]).sum(axis=0) * width

    def constraint_margins(unit: Array) -> Array:
        made = evaluator.evaluate(all_gains_at(unit))
        left = 1.0 - np.minimum(made.objectives[0, :count] / top, _LARGEST_EXCESS)
        return np.concatenate([left, -np.minimum(made.excess[0], _LARGEST_EXCESS)])

    def constraint_slopes(unit: Array) -> Array:
        if not math.isfinite(evaluator.evaluate(all_gains_at(unit)).Ms[0]):
            return np.zeros((count + 3, len(unit)))
        objectives, excess = evaluator.slopes(all_gains_at(unit)[0])
        return -np.concatenate([objectives[:count] / top[:, None], excess])[:, places] * width

    found = minimize(
        value, (start - low) / width, jac=slope, bounds=[(0.0, 1.0)] * len(places), method="SLSQP",
        constraints=NonlinearConstraint(constraint_margins, 0.0, np.inf, jac=constraint_slopes),
        options={"maxiter": 50, "ftol": 1e-10},  # iterations at most, and change of the cost at the end; chosen
    )  # fmt: skip
    unit = np.clip(found.x, 0.0, 1.0)
    unit[unit < _ROUNDING] = 0.0
    return low + unit * width
