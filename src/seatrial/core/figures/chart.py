"""A figure: panels, each a pair of axes in a box with marks in data coordinates, below a legend."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from seatrial.core.text.numbers import exact

# Marks of a figure in data coordinates, and their styles.

Array = NDArray[np.float64]

ACCENT, GREY, INK, SECOND = "#1b4f72", "#b2b2b2", "#222222", "#a33022"
# mean width of a letter over the size of the font, of Arial in mixed text
LETTER_WIDTH = 0.56
# size of the font of names and titles [px]
TEXT_SIZE = 11.0


def text_width(words: str, size: float = TEXT_SIZE) -> float:
    """Return the estimated width of words in px at a font size in px."""
    return LETTER_WIDTH * size * len(words)


class Anchor(StrEnum):
    """Which end of a text stands at its position; the values are those of SVG."""

    START = "start"
    MIDDLE = "middle"
    END = "end"


class Shape(StrEnum):
    """Outline of a marker."""

    CIRCLE = "circle"
    CROSS = "cross"
    PLUS = "plus"
    DIAMOND = "diamond"
    SQUARE = "square"
    UP = "up"
    DOWN = "down"
    RIGHT = "right"
    UPRIGHT = "upright"


@dataclass(frozen=True)
class Stroke:
    """Style of a line: colour, width in px, dash lengths in px separated by spaces as in SVG."""

    colour: str
    width: float
    dash: str = ""


@dataclass(frozen=True)
class Marker:
    """Style of a point; `size` is half its width in px, `edge_width` in px."""

    shape: Shape
    size: float
    edge: str
    fill: str = "none"
    edge_width: float = 1.2  # px, chosen


@dataclass(frozen=True)
class Line:
    """Line through points in data coordinates; NaN leaves a gap."""

    x: Array
    y: Array
    stroke: Stroke


@dataclass(frozen=True)
class Points:
    """Markers at points in data coordinates; points outside the panel and NaN are left out."""

    x: Array
    y: Array
    marker: Marker


@dataclass(frozen=True)
class Area:
    """Closed outline in data coordinates, filled; points with NaN are left out."""

    x: Array
    y: Array
    fill: str
    stroke: Stroke | None = None


@dataclass(frozen=True)
class Rectangle:
    """Filled rectangle between two corners in data coordinates; `gap` px are left free at its right and lower edge."""

    left: float
    bottom: float
    right: float
    top: float
    fill: str
    gap: float = 0.0
    edge: Stroke | None = None


@dataclass(frozen=True)
class Rule:
    """Straight line across the panel at a value of y, or of x where it is vertical."""

    value: float
    stroke: Stroke
    is_vertical: bool = False


@dataclass(frozen=True)
class Text:
    """Words at a point in data coordinates, moved by (dx, dy) px to the right and down; `turn` in degrees clockwise."""

    x: float
    y: float
    words: str
    anchor: Anchor = Anchor.START
    size: float = TEXT_SIZE
    colour: str = INK
    dx: float = 0.0
    dy: float = 0.0
    turn: float = 0.0


Mark = Line | Points | Area | Rectangle | Rule | Text


# Round numbers along an axis, ranges about values, and fewer points of a curve without a visible difference.

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
    values = min(inside, key=lambda multiples: (len(multiples) < 2, abs(len(multiples) - count)))
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


def local_means(values: Array, points: int = POINTS) -> Array:
    """Return the means of at most so many stretches of equal length, NaN left out; the first and last value stay."""
    if len(values) <= points:
        return values
    edges = np.linspace(0, len(values), points + 1).astype(int)
    finite = np.isfinite(values)
    sums, counts = (np.add.reduceat(a, edges[:-1]) for a in (np.where(finite, values, 0.0), finite.astype(float)))
    means = np.divide(sums, counts, out=np.full(points, np.nan), where=counts > 0.0)
    return np.concatenate([values[:1], means[1:-1], values[-1:]])


# A figure: panels, each a pair of axes in a box with marks, below a legend.

# width of a figure on a page [px]: the text column of the report's style sheet less its padding
WIDTH = 864.0
# size of the font of ticks [px]
TICK_SIZE = 10.0


@dataclass(frozen=True)
class Axis:
    """One axis.

    Attributes:
        ends: range in data units, positive where logarithmic.
        tick_count: about how many ticks; not used where `ticks` are given.
        ticks: value and text of each tick; None: round numbers.
        has_labels, has_grid: whether the ticks have texts and grid lines.
    """

    ends: tuple[float, float]
    name: str = ""
    is_logarithmic: bool = False
    tick_count: int = 5
    ticks: tuple[Tick, ...] | None = None
    has_labels: bool = True
    has_grid: bool = True

    def share(self, values: Array | float) -> Array:
        """Return positions along the axis, 0 at its first end and 1 at its last; NaN where there is no logarithm."""
        low, high = self.ends
        if not self.is_logarithmic:
            return (np.asarray(values, float) - low) / (high - low)
        numbers = np.asarray(values, float)
        positive = np.where(numbers > 0.0, numbers, np.nan)
        return (np.log(positive) - np.log(low)) / (np.log(high) - np.log(low))

    def tick_list(self) -> tuple[Tick, ...]:
        """Return the ticks as given, else round numbers."""
        if self.ticks is not None:
            return self.ticks
        return (decade_ticks if self.is_logarithmic else linear_ticks)(*self.ends, self.tick_count)


def row_axis(names: Sequence[str], *, has_grid: bool = False) -> Axis:
    """Return an axis with a name at each of 0, 1, 2, …"""
    return Axis((-0.5, len(names) - 0.5), ticks=tuple(Tick(k, name) for k, name in enumerate(names)), has_grid=has_grid)


@dataclass(frozen=True)
class Region:
    """Rectangle of a figure in px, counted to the right and down."""

    left: float
    top: float
    width: float
    height: float

    @property
    def right(self) -> float:
        """Right edge [px]."""
        return self.left + self.width

    @property
    def bottom(self) -> float:
        """Lower edge [px]."""
        return self.top + self.height


@dataclass(frozen=True)
class Panel:
    """A pair of axes in a box with marks, the first at the bottom.

    Attributes:
        is_y_down: whether y grows downwards.
        has_frame: whether axis lines, grid, ticks and names are drawn; `has_lines`: whether the axis lines are.
        tick_size: font size of the ticks [px].
    """

    box: Region
    x: Axis
    y: Axis
    marks: tuple[Mark, ...] = ()
    title: str = ""
    is_y_down: bool = False
    has_frame: bool = True
    has_lines: bool = True
    tick_size: float = TICK_SIZE

    def px(self, x: Array | float) -> Array:
        """Return horizontal positions in px."""
        return self.box.left + self.x.share(x) * self.box.width

    def py(self, y: Array | float) -> Array:
        """Return vertical positions in px, counted downwards."""
        share = self.y.share(y)
        return self.box.top + (share if self.is_y_down else 1.0 - share) * self.box.height

    def has_turned_labels(self) -> bool:
        """Return whether texts given for the ticks of x are too long to stand side by side."""
        ticks = self.x.ticks or ()
        longest = max((text_width(tick.text, self.tick_size) for tick in ticks), default=0.0)
        return len(ticks) > 1 and longest > 0.96 * self.box.width / len(ticks)  # a gap of 4 % between two texts

    def depth(self) -> float:
        """Return the height in px that ticks and name of x take below the panel."""
        if not self.has_frame:
            return 0.0
        labels = 0.0
        if self.x.has_labels and self.has_turned_labels():
            labels = max(text_width(tick.text, self.tick_size) for tick in self.x.ticks or ()) + 12.0  # px, chosen
        elif self.x.has_labels:
            labels = self.tick_size + 7.0  # px, chosen
        return labels + (TEXT_SIZE + 5.0 if self.x.name else 0.0)  # px, chosen


# px, chosen
def tiles(count: int, columns: int, height: float, *, start: float = 0.0, left: float = 64.0, right: float = 8.0,
          gap: float = 26.0, top: float = 20.0) -> list[Region]:  # fmt: skip
    """Return boxes row by row between `start` and the right edge [px].

    `left` and `right` px are free beside each box, `gap` px between two rows.
    """
    tile = (WIDTH - start) / columns
    return [
        Region(start + tile * (k % columns) + left, top + (height + gap) * (k // columns), tile - left - right, height)
        for k in range(count)
    ]


# one line of legend [px], and the gap between it and the panels below
LEGEND_LINE, LEGEND_GAP = 18.0, 6.0
# width of the sample of a line in a legend, of any other sample, and the gap after an entry [px]
LINE_SAMPLE, MARKER_SAMPLE, ENTRY_GAP = 30.0, 16.0, 22.0


@dataclass(frozen=True)
class LegendEntry:
    """A name and what it stands for: a line, a marker, or the colour of an area."""

    words: str
    sample: Stroke | Marker | str

    @property
    def sample_width(self) -> float:
        """Width of the sample with the gap after it [px]."""
        return LINE_SAMPLE if isinstance(self.sample, Stroke) else MARKER_SAMPLE


@dataclass(frozen=True)
class LegendPosition:
    """An entry of a legend with its upper left corner in px."""

    entry: LegendEntry
    left: float
    top: float


@dataclass(frozen=True)
class Chart:
    """A figure: a title for readers who cannot see it, panels below a legend, its width in px."""

    title: str
    panels: tuple[Panel, ...]
    legend: tuple[LegendEntry, ...] = ()
    width: float = WIDTH

    def legend_positions(self) -> list[LegendPosition]:
        """Return the entries of the legend from left to right, in as many lines as they need."""
        positions: list[LegendPosition] = []
        start = min((panel.box.left for panel in self.panels), default=0.0)
        left, top = start, 2.0
        for entry in self.legend:
            width = entry.sample_width + text_width(entry.words)
            if left > start and left + width > self.width:
                left, top = start, top + LEGEND_LINE
            positions.append(LegendPosition(entry, left, top))
            left += width + ENTRY_GAP
        return positions

    def legend_height(self) -> float:
        """Return the height in px by which the legend moves the panels down."""
        return max((p.top + LEGEND_LINE + LEGEND_GAP for p in self.legend_positions()), default=0.0)

    def height(self) -> float:
        """Return the height in px with legend, ticks and names."""
        return self.legend_height() + max((p.box.bottom + p.depth() for p in self.panels), default=0.0) + 4.0
