"""Tracks from above; long and narrow ones lie on their side. Hulls at equal times show the heading."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.figures.bands import track_envelope
from seatrial.core.figures.chart import Axis, Panel, Region
from seatrial.core.figures.marks import Area, Array, Line, Mark, Stroke
from seatrial.core.figures.ticks import Tick, linear_ticks, span, thinned
from seatrial.core.text.numbers import exact

# hulls along a track; ratio of extents from which a track is long and narrow
HULLS, SLENDER = 7, 2.5
# m from which on positions do not fit beside an axis
LONGEST_NUMBER = 1e5
# free distance about a track: in lengths of the ship, and as a share of the extent
FREE_LENGTHS, FREE_SHARE = 0.6, 0.03
# points of a track; finer than hulls along it, coarser than the noise of positions
POINTS = 240
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
    """Envelope, line, hulls."""
    across, along = (track.north, track.east) if is_rotated else (track.east, track.north)
    marks: list[Mark] = []
    if track.half_north is not None and track.half_east is not None:
        halves = (track.half_north, track.half_east) if is_rotated else (track.half_east, track.half_north)
        envelope = track_envelope(across, along, *halves)
        marks += [envelope] if envelope else []
    marks.append(Line(*thinned(across, along, POINTS), track.stroke))
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
