"""Round numbers along an axis, ranges about values, and fewer points of a curve without a visible difference."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from seatrial.core.figures.marks import Array
from seatrial.core.text.numbers import exact

# share of the range that stays free at either end of an axis
MARGIN = 0.06
# a value below this share of the axis' largest is rounding, not a number
ROUNDING = 1e-9


@dataclass(frozen=True)
class Tick:
    """A value of an axis and its text."""

    value: float
    text: str


def linear_ticks(low: float, high: float, count: int) -> tuple[Tick, ...]:
    """Return about `count` ticks within a range, at steps of 1, 2 or 5 times a power of ten."""
    if not high > low:
        return (Tick(low, exact(low)),)
    power = 10.0 ** math.floor(math.log10((high - low) / max(1, count)))
    choices = [_multiples(low, high, m * power) for m in (0.5, 1.0, 2.0, 5.0, 10.0)]  # px, chosen
    values = min(choices, key=lambda choice: (len(choice) < 2, abs(len(choice) - count)))
    largest = max(abs(low), abs(high))
    return tuple(Tick(v, "0" if abs(v) < ROUNDING * largest else exact(v)) for v in values)


def _multiples(low: float, high: float, step: float) -> list[float]:
    first, last = math.ceil(low / step - ROUNDING), math.floor(high / step + ROUNDING)
    return [k * step + 0.0 for k in range(first, last + 1)]


def decade_ticks(low: float, high: float, count: int) -> tuple[Tick, ...]:
    """Return about `count` ticks of a logarithmic axis: powers of ten, with 3, or 2 and 5, times them where few."""
    powers = range(math.floor(math.log10(low) - ROUNDING), math.ceil(math.log10(high) + ROUNDING) + 1)
    stride = 1 + len(powers) // (2 * count)
    choices = [[10.0**power for power in powers if power % stride == 0]]
    # px, chosen
    choices += [[step * 10.0**power for power in powers for step in steps] for steps in ((1, 3), (1, 2, 5))]
    inside = [[v for v in choice if low * (1.0 - ROUNDING) <= v <= high * (1.0 + ROUNDING)] for choice in choices]
    values = min(inside, key=lambda some: (len(some) < 2, abs(len(some) - count)))
    return tuple(Tick(v, exact(v, 2)) for v in values)


def span(arrays: Sequence[NDArray[np.float64]], margin: float = MARGIN) -> tuple[float, float]:
    """Return a range about all finite values, wider by a share `margin` of it at either end.

    About a constant it is wide enough to show that it is one; without finite values it is 0 to 1.
    """
    finite = np.concatenate([a[np.isfinite(a)] for a in arrays]) if arrays else np.empty(0)
    if finite.size == 0:
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    # px, chosen
    free = margin * (high - low) if high - low > ROUNDING * max(abs(low), abs(high)) else 0.05 * abs(low) or 1.0
    return low - free, high + free


def whole_decades(values: Sequence[float], least: tuple[float, float]) -> tuple[float, float]:
    """Return whole powers of ten about positive values, at least from `least[0]` to `least[1]`."""
    low = math.floor(math.log10(min([*values, least[0]])) + ROUNDING)
    high = math.ceil(math.log10(max([*values, least[1]])) - ROUNDING)
    return 10.0**low, 10.0**high


# points of a curve: more than a panel of a page has pixels for extremes
POINTS = 400


def decimated(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """Return a curve of at most about `points` points that keeps the extremes of every stretch; NaN stays NaN."""
    if len(x) <= points:
        return x, y
    edges = np.linspace(0, len(x), points // 2 + 1).astype(int)
    low, high = np.where(np.isnan(y), np.inf, y), np.where(np.isnan(y), -np.inf, y)
    kept: list[int] = []
    for first, last in pairwise(edges):
        kept += sorted({first + int(np.argmin(low[first:last])), first + int(np.argmax(high[first:last]))})
    return x[kept], y[kept]


def thinned(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """Return evenly chosen points of a curve, its ends among them."""
    kept = np.unique(np.linspace(0, len(x) - 1, min(points, len(x))).astype(int))
    return x[kept], y[kept]
