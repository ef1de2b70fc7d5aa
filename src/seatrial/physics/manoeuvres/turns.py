"""Turns of a craft at its own time scale: what its heading does beyond waves and the steps of a compass."""

from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np

from seatrial.core.values import Array
from seatrial.core.values.arrays import Mask, mask_intervals

Values = TypeVar("Values", Array, Mask)
# rad of the smallest turn: waves yaw less than the larger, headings in whole degrees step by less than the smaller; a
# log that turns less than twice the larger is judged by half of what it turns; chosen
_LARGEST_THRESHOLD, _SMALLEST_THRESHOLD = np.radians(8.0), np.radians(3.0)
# of the smallest turn: the heading's range on a steady course, and how far it leaves one as a turn begins; chosen
_STEADY_SHARE, _EDGE_SHARE = 0.625, 0.125
_STEADY_TIMES = 6.0  # time scales that a steady course lasts: it turns at a tenth of the largest rate at most; chosen
_LOOKS = 8  # means of the heading within one time scale; chosen: shorter than any turn
_LONGEST_SHARE = 1.0 / 6.0  # of the record that a time scale is at most; chosen


@dataclass(frozen=True)
class HeadingTurn:
    """Rows first..last of a turn and the change of heading [rad], positive to starboard."""

    first: int
    last: int
    angle: float

    @property
    def side(self) -> str:
        """To which it turns."""
        return "starboard" if self.angle > 0.0 else "port"


@dataclass(frozen=True, eq=False)
class Course:
    """What the heading of a record does.

    Attributes:
        scale: rows within which the craft can turn by the smallest turn, its own time scale.
        rate: the largest at that scale [rad per row].
        turns: in order; steady: first row and row after the last of each steady course.
    """

    scale: int
    rate: float
    turns: tuple[HeadingTurn, ...]
    steady: tuple[tuple[int, int], ...]

    @property
    def smallest_turn(self) -> float:
        """The change of heading [rad] from which on it is a turn."""
        return self.scale * self.rate


def course_of(psi: Array) -> Course:
    """Return turns and steady courses of a heading, unwrapped, without gaps, (n,), n >= 1.

    A heading that stays within three degrees, or twice that, does not turn: it is one steady course.
    """
    smallest = min(_LARGEST_THRESHOLD, max(_SMALLEST_THRESHOLD, 0.5 * float(np.ptp(psi))))
    scale = _time_scale(psi, smallest)
    if float(np.ptp(psi)) < 2.0 * _SMALLEST_THRESHOLD:
        return Course(scale, smallest / scale, (), ((0, len(psi)),))
    stride = max(1, scale // _LOOKS)
    looks = means_of(psi, stride)
    window = max(2, round(_STEADY_TIMES * scale / stride))
    steady = _steady(looks, window, _STEADY_SHARE * smallest)
    turns = [
        turn for a, b in pairwise(reversals(looks, smallest)) for turn in _turns_between(looks, a, b, steady, smallest)
    ]
    last = len(psi) - 1
    return Course(
        scale,
        smallest / scale,
        tuple(HeadingTurn(stride * t.first, min(stride * (t.last + 1), last), t.angle) for t in turns),
        tuple((stride * a, min(stride * b, len(psi)) if b < len(looks) else len(psi)) for a, b in steady),
    )


def _time_scale(psi: Array, angle: float) -> int:
    """The fewest rows within which the heading changes by an angle; at most a share of all."""
    most = max(1, int(_LONGEST_SHARE * len(psi)))
    high = low = psi
    widest = high, low
    length, span = 1, 0  # rows over which high and low are the extremes, and over which they were before
    while 2 * length <= most and float(np.max(high - low)) < angle:
        widest, span = (high, low), length
        high, low = (np.maximum(high[:-length], high[length:]), np.minimum(low[:-length], low[length:]))
        length *= 2
    if span == 0 or float(np.max(high - low)) < angle:
        return length
    high, low = widest
    shorter, longer = span, length
    while longer - shorter > max(1, span // _LOOKS):
        middle = (shorter + longer) // 2
        end = len(high) - (middle - span)
        spread = np.maximum(high[:end], high[middle - span :]) - np.minimum(low[:end], low[middle - span :])
        shorter, longer = (shorter, middle) if float(np.max(spread)) >= angle else (middle, longer)
    return longer


def means_of(values: Array, stride: int) -> Array:
    """Return means of so many values each, the last of those that are left."""
    starts = np.arange(0, len(values), stride)
    return np.add.reduceat(values, starts) / np.diff(np.append(starts, len(values)))


def _steady(psi: Array, window: int, band: float) -> list[tuple[int, int]]:
    """First place and place after the last where the heading stays within a band for a window."""
    if window >= len(psi):
        return []
    half = window // 2
    width = 2 * half + 1
    is_inside: Mask = _over_windows(np.maximum, psi, width) - _over_windows(np.minimum, psi, width) < band
    # a place is steady where any window about it is; none reaches beyond the record
    is_steady: Mask = _over_windows(np.maximum, np.pad(is_inside, 2 * half), width)
    return mask_intervals(is_steady)


def _over_windows(extreme: np.ufunc, values: Values, width: int) -> Values:
    """Return the extreme of each `width` neighbouring values, (n - width + 1,), by windows of which each is doubled."""
    length, doubled = 1, values
    while 2 * length <= width:
        doubled = extreme(doubled[:-length], doubled[length:])
        length *= 2
    return extreme(doubled[: len(values) - width + 1], doubled[width - length :])


def reversals(psi: Array, smallest: float) -> list[int]:
    """Return places between which an angle, (n,), goes one way, but for less than the smallest turn back.

    The first and the last one too, and between them where it leaves the first level, and where it has gone to at last.
    """
    places, low, high, side = [0], 0, 0, 0
    values = psi.tolist()
    for k, value in enumerate(values):
        low, high = (k if value < values[low] else low), (k if value > values[high] else high)
        if side <= 0 and value - values[low] > smallest:
            places, side, high = [*places, low], 1, k
        elif side >= 0 and values[high] - value > smallest:
            places, side, low = [*places, high], -1, k
        if side > 0:
            low = high
        elif side < 0:
            high = low
    return [*places, high if side > 0 else low if side < 0 else len(values) - 1, len(values) - 1]


def _turns_between(
    psi: Array, first: int, last: int, steady: list[tuple[int, int]], smallest: float
) -> list[HeadingTurn]:  # fmt: skip
    """The turns from one reversal to the next, apart where the course is steady between them."""
    calm = [(a, b) for a, b in steady if a <= last and b > first]
    levels = [(max(a, first), min(b, last + 1), float(np.median(psi[a:b]))) for a, b in calm]
    if not levels or levels[0][0] > first:
        levels = [(first, first + 1, float(psi[first])), *levels]
    if levels[-1][1] <= last:
        levels = [*levels, (last, last + 1, float(psi[last]))]
    turns = []
    for (start, _, before), (_, stop, after) in pairwise(levels):
        angle = after - before
        if abs(angle) <= smallest:
            continue
        change = np.sign(angle) * (psi[start:stop] - before)
        leaves = np.flatnonzero(change[: int(np.argmax(change > 0.5 * abs(angle))) + 1] <= _EDGE_SHARE * smallest)
        arrives = int(np.argmax(change >= abs(angle) - _EDGE_SHARE * smallest))
        turns.append(HeadingTurn(start + (int(leaves[-1]) if leaves.size else 0), start + arrives, float(angle)))
    return turns
