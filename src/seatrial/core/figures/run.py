"""One run: its track from above, its channels over time, and bands of 95 % about both."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.figures.chart import (
    WIDTH,
    Area,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Panel,
    Region,
    Rule,
    Stroke,
    Tick,
    decimated,
    linear_ticks,
    local_means,
    span,
    thinned,
    tiles,
)
from seatrial.core.text.numbers import exact

# Bands of 95 % about a curve: over time, and as a corridor along a track.

# blue of the model, transparent to 19 %
BAND = "#1b4f7230"
BAND_POINTS = 120  # px, chosen
# how far axes follow a band beyond its curves, in spans of these
REACH = 1.0
# points of a track at which a corridor has its width, and edges of an ellipse there; chosen
CORRIDOR_POINTS, ELLIPSE_EDGES = 60, 16


def band(x: Array, lower: Array, upper: Array) -> Area:
    """Return the area between two curves over x."""
    x_kept, low = thinned(x, lower, BAND_POINTS)
    high = thinned(x, upper, BAND_POINTS)[1]
    finite = np.isfinite(low) & np.isfinite(high)
    return Area(
        np.concatenate([x_kept[finite], x_kept[finite][::-1]]), np.concatenate([low[finite], high[finite][::-1]]), BAND
    )


def visible_edges(curves: list[Array], lower: Array, upper: Array) -> list[Array]:
    """Return the edges of a band as far as axes should follow them: at most one span of the curves beyond these."""
    finite = np.concatenate([c[np.isfinite(c)] for c in curves])
    if finite.size == 0:
        return []
    low, high = float(finite.min()), float(finite.max())
    reach = REACH * ((high - low) or 1.0)
    return [np.clip(edge, low - reach, high + reach) for edge in (lower, upper)]


def track_corridor(x: Array, y: Array, half_x: Array, half_y: Array) -> Area | None:
    """Return the corridor along a track to its end: ellipses about its points and what lies between; None without any.

    An ellipse has the half widths of both coordinates as axes; to the side of the track, with n the unit normal, it
    reaches h_n = sqrt((n_x h_x)^2 + (n_y h_y)^2). All parts run round the same way, so that they are filled as one.
    """
    finite = np.flatnonzero(np.isfinite(x + y + half_x + half_y))
    if len(finite) == 0:
        return None
    kept = finite[np.unique(np.linspace(0, len(finite) - 1, min(CORRIDOR_POINTS, len(finite))).astype(int))]
    middle, half = np.column_stack([x[kept], y[kept]]), np.column_stack([half_x[kept], half_y[kept]])
    angles = np.linspace(0.0, 2.0 * np.pi, ELLIPSE_EDGES + 1)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    parts = [middle[0] + half[0] * circle]
    for k in range(1, len(kept)):
        step = middle[k] - middle[k - 1]
        across = half[k - 1 : k + 1] ** 2 * [-step[1], step[0]]  # where the ellipses touch lines along the step
        reach = np.hypot(*(half[k - 1 : k + 1] * [-step[1], step[0]]).T)[:, None]
        side = np.divide(across, reach, out=np.zeros_like(across), where=reach > 0.0)
        (a, b), (p, q) = middle[k - 1 : k + 1], side
        parts += [np.array([a - p, b - q, b + q, a + p, a - p]), middle[k] + half[k] * circle]
    outline = np.vstack([*parts, *(part[:1] for part in reversed(parts[:-1]))])
    return Area(outline[:, 0], outline[:, 1], BAND)


# Tracks from above; long and narrow ones lie on their side. Hulls at equal times show the heading.

# hulls along a track; ratio of extents from which a track is long and narrow
HULLS, SLENDER = 7, 2.5
# m from which on positions do not fit beside an axis
LONGEST_NUMBER = 1e5
# free distance about a track: in lengths of the ship, and as a share of the extent
FREE_LENGTHS, FREE_SHARE = 0.6, 0.03
# points of a track, each the mean of the positions about it; finer than hulls along it
TRACK_POINTS = 240
# half a hull from above, in lengths: forward, starboard
_HALF_HULL = np.array([[0.5, 0], [0.3, 0.075], [-0.4, 0.075], [-0.5, 0.05]])
_HULL = np.vstack([_HALF_HULL, _HALF_HULL[::-1] * [1, -1], _HALF_HULL[:1]])


@dataclass(frozen=True, eq=False)
class Track:
    """Positions north and east [m], shape (n,), heading [rad] where it is known, and how they are drawn.

    half_north, half_east: half widths of a 95 % band [m].
    """

    north: Array
    east: Array
    heading: Array | None
    stroke: Stroke
    hull_fill: str = "none"
    half_north: Array | None = None
    half_east: Array | None = None


def extents(tracks: Sequence[Track]) -> tuple[float, float]:
    """Return the largest extent of any track to the north and to the east [m]."""
    north, east = (max(float(np.nanmax(a) - np.nanmin(a)) for a in arrays)
                   for arrays in ([t.north for t in tracks], [t.east for t in tracks]))  # fmt: skip
    return north, east


def is_slender(tracks: Sequence[Track]) -> bool:
    """Return whether tracks are so long and narrow that they are better drawn as a strip."""
    north, east = extents(tracks)
    return max(north, east) > SLENDER * min(north, east)


def strip_height(tracks: Sequence[Track], width: float, length: float) -> float:
    """Return the height in px of a strip of that width that shows tracks of a ship of that length at equal scales."""
    shorter, longer = sorted(extents(tracks))
    return width * (shorter + length) / (longer + length)


def track_panel(
    tracks: Sequence[Track],
    length: float,
    box: Region,
    *,
    room: Sequence[Track] = (),
    has_names: bool = True,
    x_ticks: int = 5,  # ticks, chosen
    y_ticks: int = 5,  # ticks, chosen
    title: str = "",
) -> Panel:
    """Return a panel at equal scales: north up, or to the right (east down) where the tracks are long and northerly.

    Args:
        length: of the ship [m]; 0: no hulls.
        room: further lines that the panel shows, without hulls.
    """
    north, east = extents(tracks)
    is_rotated = is_slender(tracks) and north > east
    everything = [*tracks, *room]
    across, along = (
        _widened(span([(t.north if is_north else t.east) for t in everything], 0.0), length)
        for is_north in (is_rotated, not is_rotated)
    )
    scale = max((across[1] - across[0]) / box.width, (along[1] - along[0]) / box.height)
    names = ("x₀, north [m]", "y₀, east [m]") if is_rotated else ("y₀, east [m]", "x₀, north [m]")
    x = _position_axis(_centred(across, scale * box.width), names[0], x_ticks)
    y = _position_axis(_centred(along, scale * box.height), names[1], y_ticks)
    if not has_names:
        x, y = replace(x, name=""), replace(y, name="")
    marks = [
        mark
        for track in everything
        for mark in _marks(track, length if track in tracks else 0.0, is_rotated=is_rotated)
    ]
    return Panel(box, x, y, tuple(marks), title, is_y_down=is_rotated)


def _position_axis(ends: tuple[float, float], name: str, tick_count: int) -> Axis:
    """An axis of positions; those far from the origin, as a national grid has them, are counted from a round number."""
    if max(map(abs, ends)) < LONGEST_NUMBER:
        return Axis(ends, name, tick_count=tick_count)
    step = 10.0 ** math.ceil(math.log10(ends[1] - ends[0]))
    base = step * math.floor(ends[0] / step)
    shifted = linear_ticks(ends[0] - base, ends[1] - base, tick_count)
    ticks = tuple(Tick(tick.value + base, tick.text) for tick in shifted)
    return Axis(ends, f"{name.removesuffix(' [m]')} of {exact(base)} [m]", ticks=ticks)


def _widened(ends: tuple[float, float], length: float) -> tuple[float, float]:
    free = FREE_LENGTHS * length + FREE_SHARE * (ends[1] - ends[0])
    return ends[0] - free, ends[1] + free


def _centred(ends: tuple[float, float], size: float) -> tuple[float, float]:
    middle = 0.5 * (ends[0] + ends[1])
    return middle - 0.5 * (size or 1.0), middle + 0.5 * (size or 1.0)


def _marks(track: Track, length: float, *, is_rotated: bool) -> list[Mark]:
    """Corridor, line, hulls."""
    across, along = (track.north, track.east) if is_rotated else (track.east, track.north)
    marks: list[Mark] = []
    if track.half_north is not None and track.half_east is not None:
        halves = (track.half_north, track.half_east) if is_rotated else (track.half_east, track.half_north)
        corridor = track_corridor(across, along, *halves)
        marks += [corridor] if corridor else []
    marks.append(Line(local_means(across, TRACK_POINTS), local_means(along, TRACK_POINTS), track.stroke))
    if track.heading is not None and length > 0.0:
        edge = Stroke(track.stroke.colour if track.hull_fill == "none" else "#9a9a9a", 0.8)  # px, chosen
        for i in np.linspace(0, len(track.north) - 1, HULLS).astype(int):
            outline = hull_outline(float(track.north[i]), float(track.east[i]), float(track.heading[i]), length)
            x, y = outline.T if is_rotated else outline.T[::-1]
            marks.append(Area(x, y, track.hull_fill, edge))
    return marks


def hull_outline(north: float, east: float, heading: float, length: float) -> Array:
    """Return the outline of a ship, shape (n, 2): north, east [m]; heading in rad, length in m."""
    c, s = math.cos(heading), math.sin(heading)
    return _HULL @ np.array([[c, s], [-s, c]]) * length + [north, east]


# One run: its track and its channels over time.

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


_PREFIXES = {"M": 1e6, "k": 1e3}  # of SI units, the larger first
_PREFIXED_UNIT = re.compile(r"\[(N|N m)\]")


def in_suitable_unit(channel: ChannelPanel) -> ChannelPanel:
    """Return a channel of forces or moments in kilo- or meganewtons where they are large: its ticks stay short."""
    largest = max(
        (float(np.max(np.abs(c.values), initial=0.0, where=np.isfinite(c.values))) for c in channel.curves), default=0.0
    )
    prefix = next((p for p, factor in _PREFIXES.items() if largest >= factor), "")
    if not prefix or _PREFIXED_UNIT.search(channel.label) is None:
        return channel
    factor = _PREFIXES[prefix]
    return ChannelPanel(
        _PREFIXED_UNIT.sub(rf"[{prefix}\1]", channel.label),
        tuple(replace(c, values=c.values / factor) for c in channel.curves),
        None if channel.lower is None else channel.lower / factor,
        None if channel.upper is None else channel.upper / factor,
        tuple(replace(rule, value=rule.value / factor) for rule in channel.limits),
        None if channel.ends is None else (channel.ends[0] / factor, channel.ends[1] / factor),
    )


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

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(map(in_suitable_unit, self.channels)))


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
