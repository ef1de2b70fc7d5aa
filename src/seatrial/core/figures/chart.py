"""A figure: panels, each a pair of axes in a box with marks, below a legend."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.figures.marks import TEXT_SIZE, Array, Mark, Marker, Stroke, text_width
from seatrial.core.figures.ticks import Tick, decade_ticks, linear_ticks

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
