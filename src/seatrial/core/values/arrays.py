"""Array types, arrays that cannot be written to, values between samples, values that stand for no reading."""

import math
from dataclasses import dataclass, fields
from itertools import accumulate
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seatrial.numerics.resolution import resolution

# Array types, and arrays that cannot be written to.

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]


def frozen(values: ArrayLike) -> Array:
    """Return a float64 copy that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def mask_intervals(mask: Mask) -> list[tuple[int, int]]:
    """Return first row and row after the last of every unbroken stretch of a mask, in order."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def correlation_matrix(covariance: Array) -> Array:
    """Return a covariance (n, n) scaled to a unit diagonal; rows without a variance are NaN."""
    spread = np.sqrt(np.where(np.diag(covariance) > 0, np.diag(covariance), np.nan))
    return covariance / np.outer(spread, spread)


def unwrapped(angle: Array) -> Array:
    """Angle in rad without jumps of a full turn; NaN samples stay NaN and do not break the count."""
    result = np.array(angle, dtype=float)
    is_finite = np.isfinite(result)
    if np.any(np.abs(np.diff(result[is_finite])) > np.pi):
        result[is_finite] = np.unwrap(result[is_finite])
    return result


# Angles that were averaged or interpolated as numbers where they jump by a whole turn: they run the wrong way round.

# of a turn, by which readings may lie beyond the range: rounding to whole degrees
_ROUNDED = 0.5 / 360.0
# of a turn, from either end of the range: between them an angle runs the wrong way; chosen
_END_SHARE = 1.0 / 6.0
# quantile of the steps of an angle that its craft makes, and times it that it then runs at least; chosen
_USUAL_QUANTILE, _TOO_FAST = 0.99, 5.0


def smeared_wraps(angle: Array) -> list[tuple[int, int]]:
    """Return first row and row after the last of each time an angle [rad] runs the wrong way round.

    Of an angle within 0 to 2 pi or -pi to pi; one that was unwrapped runs as its craft does.
    It then goes from one end of its range to the other through all that lies between, much faster than it ever does:
    359, 216, 130, 79, ... in place of 359, 1. What it needs to come to rest is part of it.
    """
    rows = np.flatnonzero(np.isfinite(angle))
    values = angle[rows]
    if values.size < 2 or float(np.ptp(values)) > math.tau:
        return []
    place = (values - (0.0 if values.min() >= 0.0 else -math.pi)) / math.tau
    if place.min() < -_ROUNDED or place.max() > 1.0 + _ROUNDED:  # it was unwrapped
        return []
    ends = np.flatnonzero((place < _END_SHARE) | (place > 1.0 - _END_SHARE))
    first, last = ends[:-1], ends[1:]
    is_across = (last - first > 1) & ((place[first] < 0.5) != (place[last] < 0.5))
    passages = list(zip(first[is_across].tolist(), last[is_across].tolist(), strict=True))
    steps = np.abs(np.diff(place))
    if np.count_nonzero(steps > 1.0 - _END_SHARE) >= len(passages):  # a craft that turns on and on jumps in between
        return []
    steps = np.minimum(steps, 1.0 - steps)
    is_outside = np.ones(steps.size, dtype=bool)
    for a, b in passages:
        is_outside[max(0, 2 * a - b) : 2 * b - a] = False
    usual = float(np.quantile(steps[is_outside], _USUAL_QUANTILE)) if passages and is_outside.any() else math.inf
    smeared = []
    for a, b in passages:
        if abs(place[b] - place[a]) > _TOO_FAST * usual * (b - a):
            before, after = np.flatnonzero(steps[:a] <= usual), np.flatnonzero(steps[b:] <= usual)
            start = int(before[-1]) + 1 if before.size else 0
            rest = b + int(after[0]) if after.size else len(values) - 1
            smeared.append((int(rows[start]) + 1, int(rows[min(2 * rest - a, len(values) - 1)])))
    return smeared


# How a channel runs between its samples: held until the next one, or straight to it.

Kind = Literal["", "command", "measured"]
"""Who set a channel: nobody says, an order, or a sensor."""
Between = Literal["", "held", "straight"]
"""How it runs between samples; empty: a command is held, of another one its steps decide."""
KINDS: tuple[Kind, ...] = ("command", "measured")
BETWEEN: tuple[Between, ...] = ("held", "straight")

_QUIET = 0.2  # of a move, what the samples before and after it may move at most where it is a step; chosen
_NOISE = 0.05  # of the range of the values, within which they move without being followed; chosen
_LEAST_SHARE = 0.5  # of the travel that lies within single samples where an input is held; chosen, between 0 and 1


@dataclass(frozen=True)
class Travel:
    """How far values move in all, and how far of it in steps within a single sample, in their unit."""

    total: float = 0.0
    steps: float = 0.0

    def __add__(self, more: "Travel") -> "Travel":
        """Return the travel of two records together."""
        return Travel(self.total + more.total, self.steps + more.steps)

    @property
    def is_stepped(self) -> bool:
        """Whether most of it lies within single samples: of orders all, of a slewing rudder hardly any."""
        return self.total > 0.0 and self.steps >= _LEAST_SHARE * self.total


def travel(values: Array) -> Travel:
    """Return how far the values move, (n,); moves to and fro within a twentieth of their range are noise."""
    finite = values[np.isfinite(values)]
    moves, is_step = _followed_moves(finite)
    return Travel(float(moves.sum()), float(moves[is_step].sum()))


def step_rows(values: Array) -> Index:
    """Return the rows of values (n,), all finite, that a step within a single sample reaches."""
    return np.flatnonzero(_followed_moves(values)[1]) + 1


def _followed_moves(values: Array) -> tuple[Array, Mask]:
    """Return sizes of the moves that leave a twentieth of the range, and which are steps, both (n - 1,).

    A step has hardly any move in the samples before and after it; a slewing rudder takes several samples.
    """
    if values.size < 2:
        return np.zeros(0), np.zeros(0, dtype=np.bool_)
    play = _NOISE * float(np.ptp(values))
    followed = np.fromiter(accumulate(values.tolist(), lambda y, v: min(max(y, v - play), v + play)), np.float64)
    moves = np.abs(np.diff(followed))
    beside = np.concatenate([[0.0], moves, [0.0]])
    return moves, (moves > play) & (np.maximum(beside[:-2], beside[2:]) <= _QUIET * moves)


_FEWEST_RAMPS = 3  # of one rate, by which a machinery's rate is evident; chosen
_PLAY_QUARTILES = 9.0  # lower quartiles of the moves, four standard deviations of noise between held angles; chosen
_SAME_MOVE = 1e-6  # of the greatest move, by which moves that are one differ: rounding of numbers; chosen
_LARGEST_STEP = 0.05  # of the greatest move, by which ramps of one rate differ where values are rounded; chosen
_FINE_RATE = 4.0  # plays that a move at full rate has at least, so that no noise passes for one; chosen


def with_corner_areas(values: Array) -> Array:
    """Return values (n,) that straight lines from sample to sample give the area of ramps between held angles.

    A rudder machinery slews at one rate, and turns anywhere within a sample: where the lines before and behind meet.
    The area between its corner and the chord of that sample goes to the two values about it. Values that do not move
    at one greatest rate, ramp after ramp, stay as they are.
    """
    moves = np.diff(values)
    sizes = np.abs(moves)
    greatest = float(np.max(sizes, initial=0.0))
    if greatest == 0.0:
        return values
    usual = float(np.quantile(sizes, 0.25))
    step = min(resolution(values), _LARGEST_STEP * greatest)  # values that end on the rate's own multiples have no more
    play = max(step, _PLAY_QUARTILES * usual, _SAME_MOVE * greatest)
    if greatest < _FINE_RATE * play:
        return values
    is_full = sizes >= greatest - 2.0 * play
    full = np.sign(moves) * float(np.mean(sizes[is_full]))
    course = np.where(is_full, full, np.where(sizes <= play, 0.0, np.nan))
    goes_on = (course[1:] == course[:-1]) & is_full[1:]
    if np.count_nonzero(np.diff(goes_on.astype(int), prepend=0) > 0) < _FEWEST_RAMPS:
        return values
    before, move, behind = course[:-2], moves[1:-1], course[2:]
    corner = np.flatnonzero((move - before) * (move - behind) < 0.0)
    before, move, behind = before[corner], move[corner], behind[corner]
    share = (move - behind) / (before - behind)  # of the sample before its corner: where both lines meet
    area = 0.5 * (before - behind) * share * (1.0 - share)  # of the triangle over the chord, times the sample
    centre = (1.0 + share) / 3.0  # centroid of a triangle: the mean of its corners
    result = values.copy()
    result[corner + 1] += (1.0 - centre) * area
    result[corner + 2] += centre * area
    return result


def early_turns(values: Array) -> Array:
    """Return what values (n,) lack where each move is made at once, at the machinery's rate, and then held.

    A move d takes the share |d| / D of its sample, D being the move that the machinery makes in a whole one: that which
    the values reach again and again. The area between this course and the straight line, d (1 - |d| / D) / 2 times
    the sample, goes to the two values about it in halves. With the other sign, each move ends with its sample.
    """
    moves, missing = np.diff(values), np.zeros_like(values)
    sizes = np.sort(np.abs(moves))[::-1]
    full = float(sizes[_FEWEST_RAMPS - 1]) if sizes.size >= _FEWEST_RAMPS else 0.0
    if full > 0.0:
        area = 0.5 * moves * np.maximum(1.0 - np.abs(moves) / full, 0.0)
        missing[:-1] += 0.5 * area
        missing[1:] += 0.5 * area
    return missing


def held_rows(values: Array, ratio: int) -> Array:
    """Return every `ratio`-th sample of a held channel as the mean of what was held until the next one."""
    starts = np.arange(0, len(values), ratio)
    counts = np.minimum(starts + ratio, len(values)) - starts
    return np.add.reduceat(values, starts) / counts


# Values that stand for no reading, such as -999: one far outside all others, again and again.

EMPTIED = "count as empty"
"""What a step of the provenance says of such readings; the checks repeat the sentence."""
# ranges of the other values by which such a value lies outside them, how often it occurs at least, and how many
# different values the others have at least (a switch has two); chosen
FAR_RANGES, FEWEST_TIMES, FEWEST_VALUES = 5.0, 2, 10
_TURN_SLACK = 1e-3  # rad by which rounded angles may span more than a turn: half of a tenth of a degree


def sentinel_value(values: Array, unit: str = "") -> float | None:
    """Return the one value, lowest or highest, that recurs far outside the range of all others; None: there is none.

    unit: of angles, rad, for which the way round counts: 0 lies next to 359 degrees.
    """
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return None
    for extreme in (float(finite.min()), float(finite.max())):
        rest = finite[finite != extreme]
        if finite.size - rest.size < FEWEST_TIMES or rest.size == 0:
            continue
        low, high = float(rest.min()), float(rest.max())
        distance = max(low - extreme, extreme - high)
        round_about = math.tau - (max(high, extreme) - min(low, extreme))
        if unit == "rad" and round_about > -_TURN_SLACK:
            distance = min(distance, round_about)
        if distance > FAR_RANGES * (high - low) and np.unique(rest).size >= FEWEST_VALUES:
            return extreme
    return None


# Pickling of values that hold read-only mappings, which Python's pickle does not know: by their constructor.


class PickledByConstructor:
    """A dataclass that is pickled as the call that makes it, so that it reaches other processes."""

    def __reduce__(self) -> tuple[Any, ...]:
        values = [getattr(self, field.name) for field in fields(self) if field.init]  # type: ignore[arg-type]
        return type(self), tuple(dict(value) if isinstance(value, MappingProxyType) else value for value in values)
