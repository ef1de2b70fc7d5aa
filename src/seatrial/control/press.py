"""One set of gains pressed against what it must keep, by exact gradients."""

import math

import numpy as np
from scipy.optimize import NonlinearConstraint, minimize

from seatrial.control.assess import Judge
from seatrial.core.values import Array, Index

Box = tuple[Array, Array]
_HUGE, _TINY, _ROUNDING = 1e30, 1e-300, 1e-12


def free_box(judge: Judge) -> tuple[Index, Box]:
    """Places of the free gains and their bounds."""
    gains = judge.loop.gains
    places = np.array([i for i, p in enumerate(gains) if p.free], dtype=np.int64)
    return places, (np.array([gains.items[i].lower for i in places]), np.array([gains.items[i].upper for i in places]))


def whole(judge: Judge, free: Array) -> Array:
    """All gains (n, g) of free ones (n, f); the others as the loop has them."""
    made = np.tile(judge.loop.values, (len(free), 1))
    made[:, free_box(judge)[0]] = free
    return made


def pressed(judge: Judge, start: Array, ceiling: Array | None = None) -> Array:
    """Free gains (f,) of the least product of objectives, none above its `ceiling` (m,), restrictions kept.

    SLSQP (Kraft 1988) from feasible free gains, in the unit box, on logarithms of the objectives.
    """
    places, (low, high) = free_box(judge)
    width = high - low
    count = 0 if ceiling is None else len(ceiling)
    top = np.ones(0) if ceiling is None else np.maximum(ceiling, _TINY)

    def of(unit: Array) -> Array:
        return whole(judge, (low + np.clip(unit, 0.0, 1.0) * width)[None])

    def value(unit: Array) -> float:
        return float(np.sum(np.log(np.clip(judge.of(of(unit)).objectives[0], _TINY, _HUGE))))

    def slope(unit: Array) -> Array:
        made = judge.of(of(unit)).objectives[0]
        if not np.all(np.isfinite(made) & (made > 0.0)):
            return np.zeros(len(unit))
        return (judge.slopes(of(unit)[0])[0][:, places] / made[:, None]).sum(axis=0) * width

    def room(unit: Array) -> Array:
        made = judge.of(of(unit))
        left = 1.0 - np.minimum(made.objectives[0, :count] / top, 1e3)
        return np.concatenate([left, -np.minimum(made.excess[0], 1e3)])

    def room_slope(unit: Array) -> Array:
        if not math.isfinite(judge.of(of(unit)).peak[0]):
            return np.zeros((count + 3, len(unit)))
        objectives, excess = judge.slopes(of(unit)[0])
        return -np.concatenate([objectives[:count] / top[:, None], excess])[:, places] * width

    found = minimize(
        value, (start - low) / width, jac=slope, bounds=[(0.0, 1.0)] * len(places), method="SLSQP",
        constraints=NonlinearConstraint(room, 0.0, np.inf, jac=room_slope), options={"maxiter": 50, "ftol": 1e-10},
    )  # fmt: skip
    unit = np.clip(found.x, 0.0, 1.0)
    unit[unit < _ROUNDING] = 0.0
    return low + unit * width
