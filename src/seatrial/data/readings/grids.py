"""Columns of a run on two even grids: one over all of it, one over its liveliest part."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array
from seatrial.core.values.arrays import frozen, sentinel_value
from seatrial.numerics.resolution import resolution

Signal = NDArray[Any]
"""What a reading shows on a grid, (n,): real, or in the plane as north + i east or ahead + i aside."""
BINS = 240
"""Bins of a grid; chosen: a manoeuvre has some ten of them, and all readings are compared within a second."""
_LEAST_BINS = 24  # of a grid; chosen: what relations need, of runs of few samples too
_LIVELY_SHARE = 12  # of a run, one part of so many, on the fine grid; chosen
_TURNS = (360.0, math.tau, 36000.0, 3600.0)  # full turns as numbers: deg, rad, 1/100 and 1/10 deg
# share of a turn that a step must jump to be a wrap, and of the steps that may; chosen
_JUMP, _JUMPS = 0.62, 0.34
_TURN_SLACK = 1.02  # of a full turn, to which rounded numbers may reach; chosen
_LEAST_FILLED = 0.5  # share of bins with a reading below which readings are taken one by one; chosen


@dataclass(frozen=True, eq=False)
class Samples:
    """The numbers of a column with their times [s], (n,) each, as they stand in the log.

    is_angle: whether it may jump by a full turn.
    """

    seconds: Array
    cells: Array
    is_angle: bool = False

    @cached_property
    def readings(self) -> tuple[Array, Array]:
        """Times and numbers of the readings: without empty cells and without the one number that means none."""
        sentinel = sentinel_value(self.cells)
        finite = np.isfinite(self.cells) & np.isfinite(self.seconds)
        finite &= True if sentinel is None else self.cells != sentinel
        return self.seconds[finite], self.cells[finite]

    @cached_property
    def turn(self) -> float:
        """The number at which an angle jumps back; 0: it does not."""
        if not self.is_angle:
            return 0.0
        cells = self.readings[1]
        steps = np.abs(np.diff(cells))
        reach = float(np.ptp(cells)) if cells.size else 0.0
        wrapping = (turn for turn in _TURNS if _JUMP * turn < reach <= _TURN_SLACK * turn)
        return next((t for t in wrapping if 0.0 < np.mean(steps > _JUMP * t) < _JUMPS), 0.0)

    @cached_property
    def unwrapped(self) -> Array:
        """The readings without jumps by a full turn, about the level at which they began."""
        cells = self.readings[1]
        return np.unwrap(cells, period=self.turn) if self.turn else cells

    @cached_property
    def interval(self) -> float:
        """The usual time from reading to reading [s]."""
        return float(np.median(np.diff(self.readings[0])))

    @cached_property
    def means(self) -> dict["Grid", Array]:
        """What `Grid.means` found of them, on each grid."""
        return {}

    @cached_property
    def resolution(self) -> float:
        """The step in which the numbers were written; 0: none shows."""
        return resolution(self.readings[1])


@dataclass(frozen=True, eq=False)
class Grid:
    """Even bins of a run: their edges [s], (n + 1,)."""

    edges: Array

    @property
    def step(self) -> float:
        """s from bin to bin."""
        return float(self.edges[1] - self.edges[0])

    def means(self, samples: Samples) -> Array:
        """Return the means of the unwrapped readings in the bins, straight lines across empty ones, (n,); read-only.

        Bins before the first and after the last reading are NaN.
        """
        if self not in samples.means:
            samples.means[self] = frozen(self._means(samples))
        return samples.means[self]

    def _means(self, samples: Samples) -> Array:
        seconds, cells = samples.readings[0], samples.unwrapped
        centres = 0.5 * (self.edges[1:] + self.edges[:-1])
        place = np.searchsorted(self.edges, seconds, side="right") - 1
        inside = (place >= 0) & (place < len(centres))
        counts = np.bincount(place[inside], minlength=len(centres))
        sums = np.bincount(place[inside], cells[inside], minlength=len(centres))
        if not np.any(counts):
            return np.full(len(centres), np.nan)
        filled = counts > 0
        means = np.interp(centres, centres[filled], sums[filled] / counts[filled])
        if np.mean(filled) < _LEAST_FILLED:
            means = np.interp(centres, seconds, cells)
        means[(centres < seconds[0] - self.step) | (centres > seconds[-1] + self.step)] = np.nan
        return means


def grids(columns: Sequence[Samples]) -> tuple[Grid, ...]:
    """Return the grid of the whole run and that of its liveliest part; none where there is no time."""
    spans = [entry.readings[0][[0, -1]] for entry in columns if entry.readings[0].size > 2]
    if not spans or (stop := max(s[1] for s in spans)) <= (start := min(s[0] for s in spans)):
        return ()
    finest = min(entry.interval for entry in columns if entry.readings[0].size > 2)
    overall = _grid(start, stop, finest)
    count = len(overall.edges) - 1
    moves = np.zeros(count)
    for entry in columns:
        means = np.nan_to_num(overall.means(entry))
        size = float(np.std(means))
        moves[1:] += np.abs(np.diff(means)) / size if size > 0.0 else 0.0
    width = max(count // _LIVELY_SHARE, 1)
    activity = np.convolve(moves, np.ones(width), "valid")
    first = int(np.argmax(activity))
    return overall, _grid(overall.edges[first], overall.edges[first + width], finest)


def _grid(start: float, stop: float, finest: float) -> Grid:
    """Even bins of a span, none narrower than the finest samples: there the numbers hold no noise of their own."""
    bins = math.floor((stop - start) / finest) if finest > 0.0 else BINS
    return Grid(np.linspace(start, stop, min(max(bins, _LEAST_BINS), BINS) + 1))
