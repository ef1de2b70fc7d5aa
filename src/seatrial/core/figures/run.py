"""One run: its track and its channels over time."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.figures.bands import band, visible_edges
from seatrial.core.figures.chart import WIDTH, Axis, Chart, LegendEntry, Panel, Region, tiles
from seatrial.core.figures.marks import Array, Line, Mark, Stroke
from seatrial.core.figures.ticks import decimated, span
from seatrial.core.figures.tracks import Track, is_slender, strip_height, track_panel

# height of a channel's panel and the gap between two [px]
HEIGHT, GAP = 96.0, 26.0
LEFT = 56.0  # px, chosen
# width of the track's column [px], and the least height of a strip
TRACK_WIDTH, MIN_STRIP = WIDTH / 3 + 20.0, 60.0


@dataclass(frozen=True, eq=False)
class TimeCurve:
    """Values over time [s] in the unit of the panel, shape (n,) each, and how they are drawn."""

    time: Array
    values: Array
    stroke: Stroke


@dataclass(frozen=True, eq=False)
class ChannelPanel:
    """Curves of one channel with its label; `lower` and `upper` are the edges of a band about the last curve."""

    label: str
    curves: tuple[TimeCurve, ...]
    lower: Array | None = None
    upper: Array | None = None


def run_chart(title: str, channels: Sequence[ChannelPanel], tracks: Sequence[Track], length: float,
              legend: Sequence[LegendEntry] = ()) -> Chart:  # fmt: skip
    """Return track and channels of one run; the channels stand beside the track, or below it where it is a strip.

    Args:
        tracks: with positions; empty where there are none.
        length: of the ship [m]; 0: no hulls along the track.
    """
    panels, left, top, columns, height = [], 0.0, 6.0, 3, HEIGHT  # px, chosen
    if tracks and is_slender(tracks):
        width = WIDTH - LEFT - 8.0  # px, chosen
        box = Region(LEFT, top, width, max(MIN_STRIP, strip_height(tracks, width, length)))
        panels.append(track_panel(tracks, length, box, x_ticks=9, y_ticks=3))  # ticks, chosen
        top = box.bottom + panels[0].depth() + 12.0  # px, chosen
    elif tracks:
        side = TRACK_WIDTH - LEFT - 8.0  # px, chosen
        panels.append(track_panel(tracks, length, Region(LEFT, top, side, side)))
        left, columns = TRACK_WIDTH, 2
        height = max(HEIGHT - 10.0, side / max(math.ceil(len(channels) / columns), 1) - GAP + 4.0)
    boxes = tiles(len(channels), columns, height, start=left, left=LEFT, right=10.0, gap=GAP, top=top)
    panels += [channel_panel(c, box, is_last=k >= len(channels) - columns)
               for k, (c, box) in enumerate(zip(channels, boxes, strict=True))]  # fmt: skip
    return Chart(title, tuple(panels), tuple(legend))


# ticks, chosen
def channel_panel(channel: ChannelPanel, box: Region, *, is_last: bool = True, x_ticks: int = 5, y_ticks: int = 4,
                  points: int = 400) -> Panel:  # fmt: skip
    """Return one channel over time; the last of a column names the time."""
    values, marks = [curve.values for curve in channel.curves], list[Mark]()
    if channel.lower is not None and channel.upper is not None:
        marks.append(band(channel.curves[-1].time, channel.lower, channel.upper))
        values += visible_edges(values, channel.lower, channel.upper)
    marks += [Line(*decimated(curve.time, curve.values, points), curve.stroke) for curve in channel.curves]
    start, end = float(channel.curves[0].time[0]), float(channel.curves[0].time[-1])
    x = Axis((start, end if end > start else start + 1.0), "t [s]" if is_last else "", tick_count=x_ticks)
    return Panel(box, x, Axis(span(values), channel.label, tick_count=y_ticks), tuple(marks))
