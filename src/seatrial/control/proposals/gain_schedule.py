"""A schedule's gains between its conditions, and where its conditions end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.control.schedule import schedule_conditions
from seatrial.control.task import ScheduleGrid, TuningTask
from seatrial.core.results.tuning import OperatingPoint
from seatrial.core.values import Array, InputError

_AXES = ("speeds", "headings", "heights")
_SAME = 0.01  # relative difference of Ms that other nodes and versions explain; chosen
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
        limits = [self.limits(k) for k in range(len(_AXES))]
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


def refuse_other_craft(task: TuningTask, points: Sequence[OperatingPoint], source: str) -> None:
    """Refuse a schedule that was not tuned for this loop: other gains, or other margins than it was written with.

    source: the schedule's file, in words.

    Raises:
        InputError: it was tuned for another loop.
    """
    names = task.loop.gains.names
    if set(points[0].gains) != set(names):
        raise InputError(
            f"{source} has gains {', '.join(points[0].gains)}, the loop has {', '.join(names)}: they are of two loops; "
            "run 'seatrial tune' on this loop file again"
        )
    for point in (points[0], points[-1]):
        grid = ScheduleGrid((point.U,), (point.beta,), (point.height,))
        evaluator = schedule_conditions(task, grid)[0].evaluator
        Ms = float(evaluator.evaluate(np.array([[point.gains[name] for name in names]])).Ms[0])
        if not math.isclose(Ms, point.Ms, rel_tol=_SAME):
            raise InputError(
                f"{source} says Ms {point.Ms:.3f} at {point.U:.3g} m/s, with this loop file it is {Ms:.3f}: it was "
                "tuned for another craft, or the loop file has changed; run 'seatrial tune' on it again"
            )
