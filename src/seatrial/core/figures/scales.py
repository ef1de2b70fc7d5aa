"""Axes that are linear or logarithmic, with their grid; marks of points; legends that wrap."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.figures.plot import (
    AXIS,
    FAINT,
    INK,
    WIDTH,
    Panel,
    Stroke,
    segment,
    span,
    text,
    tick_text,
    ticks,
)  # fmt: skip
from seatrial.core.text.numbers import exact
from seatrial.core.values import Array

# from this ratio of largest to smallest on, an axis of positive numbers is logarithmic
WIDE = 12.0
_LETTER = 5.7


@dataclass(frozen=True)
class Scale:
    """One axis: `ends` are logarithms to base ten where it is logarithmic."""

    ends: tuple[float, float]
    is_logarithmic: bool

    def coordinates(self, values: Array) -> Array:
        """Values as the panel's coordinates; NaN where there is no logarithm."""
        if not self.is_logarithmic:
            return np.where(np.isfinite(values), values, np.nan)
        positive = np.isfinite(values) & (values > 0.0)
        return np.where(positive, np.log10(np.where(positive, values, 1.0)), np.nan)

    def ticks(self, count: int) -> list[tuple[float, str]]:
        """Coordinates and texts of the ticks."""
        if not self.is_logarithmic:
            return [(v, tick_text(v, self.ends)) for v in ticks(*self.ends, count)]
        choices = [_decades(self.ends, steps) for steps in ((1,), (1, 3), (1, 2, 5))]
        return min(choices, key=lambda candidate: (len(candidate) < 2, abs(len(candidate) - count)))


def _decades(ends: tuple[float, float], steps: tuple[int, ...]) -> list[tuple[float, str]]:
    powers = range(math.floor(ends[0]), math.ceil(ends[1]) + 1)
    values = [(math.log10(step) + power, exact(step * 10.0**power, 2)) for power in powers for step in steps]
    return [pair for pair in values if ends[0] <= pair[0] <= ends[1]]


def scale_of(values: Sequence[Array], margin: float = 0.06) -> Scale:
    """An axis about all finite values, logarithmic where they are positive and far apart."""
    known = np.concatenate([v[np.isfinite(v)] for v in values]) if values else np.empty(0)
    if known.size and known.min() > 0.0 and known.max() > WIDE * known.min():
        return Scale(span([np.log10(known)], margin), is_logarithmic=True)
    return Scale(span([known], margin), is_logarithmic=False)


def grid(panel: Panel, x: Scale, y: Scale, *, x_label: str = "", y_label: str = "", title: str = "",
         tick_counts: tuple[int, int] = (5, 5)) -> str:  # fmt: skip
    """Grid, axis lines, tick labels and names; `about`: numbers of ticks along x and y."""
    bottom, right = panel.top + panel.height, panel.left_edge + panel.width
    faint, line, parts = Stroke(FAINT, 0.8), Stroke(AXIS, 0.8), []
    for at, words in x.ticks(tick_counts[0]):
        place = float(panel.px(at))
        parts.append(segment(place, panel.top, place, bottom, faint))
        parts.append(text(place, bottom + 13, words, anchor="middle", size=10))
    for at, words in y.ticks(tick_counts[1]):
        place = float(panel.py(at))
        parts.append(segment(panel.left_edge, place, right, place, faint))
        parts.append(text(panel.left_edge - 4, place + 3.6, words, anchor="end", size=10))
    parts += [
        segment(panel.left_edge, panel.top, panel.left_edge, bottom, line),
        segment(panel.left_edge, bottom, right, bottom, line),
    ]
    parts.append(text((panel.left_edge + right) / 2, bottom + 29, x_label, anchor="middle") if x_label else "")
    middle = panel.top + panel.height / 2
    parts.append(text(panel.left_edge - 42, middle, y_label, anchor="middle", turn=-90) if y_label else "")
    parts.append(text(panel.left_edge, panel.top - 7, title) if title else "")
    return "".join(parts)


_SHAPES = {
    "diamond": ((0, -1.35), (1.35, 0), (0, 1.35), (-1.35, 0)),
    "square": ((-1, -1), (1, -1), (1, 1), (-1, 1)),
    "up": ((0, -1.25), (1.2, 0.95), (-1.2, 0.95)),
    "down": ((0, 1.25), (1.2, -0.95), (-1.2, -0.95)),
    "right": ((1.25, 0), (-0.95, 1.2), (-0.95, -1.2)),
}


@dataclass(frozen=True)
class Mark:
    """A point's shape: ``dot``, ``cross`` or a polygon's name; `size` [px] is its half width."""

    shape: str
    size: float
    edge: str
    fill: str = "none"

    def svg(self, px: Array, py: Array) -> str:
        """One path for all places [px]; those that are NaN are left out."""
        known = np.isfinite(px) & np.isfinite(py)
        places = list(zip(px[known], py[known], strict=True))
        if not places:
            return ""
        if self.shape == "dot":
            way = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in places)
            return (
                f'<path d="{way}" fill="none" stroke="{self.edge}" stroke-width="{2 * self.size:g}" '
                'stroke-linecap="round"/>'
            )
        s = self.size
        if self.shape == "cross":
            way = "".join(f"M{x - s:.1f} {y - s:.1f}l{2 * s:g} {2 * s:g}m0 {-2 * s:g}l{-2 * s:g} {2 * s:g}"
                          for x, y in places)  # fmt: skip
        else:
            way = "".join("M" + "L".join(f"{x + s * a:.1f} {y + s * b:.1f}" for a, b in _SHAPES[self.shape]) + "Z"
                          for x, y in places)  # fmt: skip
        return f'<path d="{way}" fill="{self.fill}" stroke="{self.edge}" stroke-width="1.3"/>'


Entry = tuple[str, Mark | Stroke]


def legend(
    entries: Sequence[Entry], left_edge: float = 0.0, top: float = 4.0, right: float = WIDTH
) -> tuple[str, float]:
    """A sample of its mark or line before each name, wrapped, and where the next thing may begin [px]."""
    parts, x = [], left_edge
    for words, kind in entries:
        sample = 30.0 if isinstance(kind, Stroke) else 16.0
        width = sample + _LETTER * len(words) + 22
        if x > left_edge and x + width > right:
            x, top = left_edge, top + 18.0
        if isinstance(kind, Stroke):
            parts.append(segment(x, top + 6, x + sample - 6, top + 6, kind))
        else:
            parts.append(kind.svg(np.array([x + 6]), np.array([top + 6])))
        parts.append(text(x + sample, top + 10, words, colour=INK))
        x += width
    return "".join(parts), top + 20.0 if entries else top
