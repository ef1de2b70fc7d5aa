"""One run: its track and its channels over time."""

import math
from dataclasses import dataclass

from seatrial.core.figures.bands import band, visible_edges
from seatrial.core.figures.chart import WIDTH, Axis, Chart, LegendEntry, Panel, Region, tiles
from seatrial.core.figures.marks import Array, Line, Mark, Rule, Stroke
from seatrial.core.figures.ticks import decimated, span
from seatrial.core.figures.tracks import Track, is_slender, strip_height, track_panel

# height of a channel's panel and the gap between two [px]
HEIGHT, GAP = 96.0, 26.0
LEFT = 56.0  # px, chosen
# width of the track's column [px], the least height of a strip, and the side of a track that stands by itself
TRACK_WIDTH, MIN_STRIP, TRACK_SIDE = WIDTH / 3 + 20.0, 60.0, 330.0
# width of a strip for a telephone, and of its axis for each tick [px]; chosen
NARROW, TICK_SPACING = 358.0, 89.0


@dataclass(frozen=True, eq=False)
class TimeCurve:
    """Values over time [s] in the unit of the panel, shape (n,) each, and how they are drawn; `name` for readers."""

    time: Array
    values: Array
    stroke: Stroke
    name: str = ""


@dataclass(frozen=True, eq=False)
class ChannelPanel:
    """Curves of one channel with its label.

    `lower` and `upper` are the edges of a band about the last curve; `limits` are levels that are marked; `ends` is the
    range of the axis, None: about what is shown.
    """

    label: str
    curves: tuple[TimeCurve, ...]
    lower: Array | None = None
    upper: Array | None = None
    limits: tuple[Rule, ...] = ()
    ends: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class RunView:
    """What a figure of one run shows.

    Attributes:
        tracks: with positions; empty where there are none.
        length: of the ship [m]; 0: no hulls along the track.
    """

    title: str
    channels: tuple[ChannelPanel, ...]
    tracks: tuple[Track, ...] = ()
    length: float = 0.0
    legend: tuple[LegendEntry, ...] = ()


def run_chart(view: RunView) -> Chart:
    """Return track and channels of one run; the channels stand beside the track, or below it where it is a strip."""
    panels, left, top, columns, height = list[Panel](), 0.0, 6.0, 3, HEIGHT  # px, chosen
    if view.tracks:
        panels.append(_track(view, TRACK_WIDTH - LEFT - 8.0))  # px, chosen
        box = panels[0].box
        if is_slender(view.tracks):
            top = box.bottom + panels[0].depth() + 12.0  # px, chosen
        else:
            left, columns = TRACK_WIDTH, 2
            height = max(HEIGHT - 10.0, box.height / max(math.ceil(len(view.channels) / columns), 1) - GAP + 4.0)
    boxes = tiles(len(view.channels), columns, height, start=left, left=LEFT, right=10.0, gap=GAP, top=top)
    panels += [channel_panel(c, box, is_last=k >= len(view.channels) - columns)
               for k, (c, box) in enumerate(zip(view.channels, boxes, strict=True))]  # fmt: skip
    return Chart(view.title, tuple(panels), view.legend)


def track_chart(view: RunView, width: float = WIDTH) -> Chart | None:
    """Return the track of one run by itself; None where it has none. width: of a strip [px]."""
    if not view.tracks:
        return None
    panel = _track(view, TRACK_SIDE, width)
    return Chart(f"{view.title}: track", (panel,), width=panel.box.right + 8.0)  # px, chosen


def _track(view: RunView, side: float, strip_width: float = WIDTH) -> Panel:
    """The panel of the track: a square of that side, or a strip of that width [px]."""
    if not is_slender(view.tracks):
        return track_panel(view.tracks, view.length, Region(LEFT, 6.0, side, side))  # px, chosen
    width = strip_width - LEFT - 8.0  # px, chosen
    box = Region(LEFT, 6.0, width, max(MIN_STRIP, strip_height(view.tracks, width, view.length)))  # px, chosen
    return track_panel(view.tracks, view.length, box, x_ticks=round(width / TICK_SPACING), y_ticks=3)  # ticks, chosen


# ticks, chosen
def channel_panel(channel: ChannelPanel, box: Region, *, is_last: bool = True, x_ticks: int = 5, y_ticks: int = 4,
                  points: int = 400) -> Panel:  # fmt: skip
    """Return one channel over time; the last of a column names the time."""
    values, marks = [curve.values for curve in channel.curves], list[Mark]()
    if channel.lower is not None and channel.upper is not None:
        marks.append(band(channel.curves[-1].time, channel.lower, channel.upper))
        values += visible_edges(values, channel.lower, channel.upper)
    marks += [Line(*decimated(curve.time, curve.values, points), curve.stroke) for curve in channel.curves]
    marks += channel.limits
    start, end = float(channel.curves[0].time[0]), float(channel.curves[0].time[-1])
    y_ends = channel.ends or span(values)
    x = Axis((start, end if end > start else start + 1.0), "t [s]" if is_last else "", tick_count=x_ticks)
    return Panel(box, x, Axis(y_ends, channel.label, tick_count=y_ticks), tuple(marks))
