"""A figure: panels below a legend."""

from dataclasses import dataclass

from seatrial.core.figures.marks import Marker, Stroke, text_width
from seatrial.core.figures.panel import WIDTH, Panel

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
