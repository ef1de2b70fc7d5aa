"""Tracks from above; long and narrow ones lie on their side. Little ships at equal times show the heading."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.figures import bands
from seatrial.core.figures.plot import (
    MEASURED,
    PLAIN,
    SIMULATED,
    WIDTH,
    Panel,
    Stroke,
    axes,
    common_prefix,
    drawing,
    path,
    span,
    thinned,
)  # fmt: skip
from seatrial.core.results import Prediction
from seatrial.core.values import Array, Record

SHIPS, SLENDER = 7, 2.5
COLUMNS, STRIP_COLUMNS = 4, 2
TOP, LEFT, BELOW = 22.0, 52.0, 34.0
# half a ship from above, in lengths: forward, starboard
_HULL = np.array([[0.5, 0], [0.3, 0.075], [-0.4, 0.075], [-0.5, 0.05]])
_OUTLINE = np.vstack([_HULL, _HULL[::-1] * [1, -1], _HULL[:1]])


@dataclass(frozen=True)
class TrackView:
    """How a track lies on the page: north up, or (`lying`) north to the right and east downwards."""

    is_rotated: bool

    def horizontal(self, record: Record) -> Array:
        """The coordinate that runs to the right [m]."""
        return record["x0"] if self.is_rotated else record["y0"]

    def vertical(self, record: Record) -> Array:
        """The other coordinate [m]: up, or down where the track lies."""
        return record["y0"] if self.is_rotated else record["x0"]


def has_track(record: Record) -> bool:
    """Whether positions are there."""
    return {"x0", "y0"} <= set(record.channels) and bool(np.isfinite(record["x0"] + record["y0"]).any())


def extents(records: Sequence[Record]) -> tuple[float, float]:
    """Largest extent of any record to the north and to the east [m]."""
    north, east = (max(float(np.nanmax(r[s]) - np.nanmin(r[s])) for r in records) for s in ("x0", "y0"))
    return north, east


def is_slender(records: Sequence[Record]) -> bool:
    """Whether tracks are so long and narrow that they are better drawn as a strip."""
    north, east = extents(records)
    return max(north, east) > SLENDER * min(north, east)


def tracks(records: Sequence[Record], length: float) -> str:
    """Small multiples of all tracks, strips first; empty where no record has positions."""
    usable = [r for r in records if has_track(r)]
    prefix = common_prefix([r.name for r in records])
    strips = [r for r in usable if is_slender([r])]
    others = [r for r in usable if not is_slender([r])]
    drawn_strips, below = _tiles(strips, length, prefix, 0.0, STRIP_COLUMNS)
    drawn_others, bottom = _tiles(others, length, prefix, below, COLUMNS)
    return drawing([*drawn_strips, *drawn_others], bottom, "tracks of the records") if usable else ""


def _tiles(records: Sequence[Record], length: float, prefix: str, top: float, columns: int) -> tuple[list[str], float]:
    """Tiles of one row after another below `top`; the parts, and where they end."""
    parts = []
    for k in range(0, len(records), columns):
        row, top = _row(records[k : k + columns], length, prefix, top, columns)
        parts += row
    return parts, top


def _row(records: Sequence[Record], length: float, prefix: str, top: float, columns: int) -> tuple[list[str], float]:
    tile = WIDTH / columns
    inner = tile - LEFT - 12
    ratio = max(min(extents([r])) / (max(extents([r])) or 1.0) for r in records)
    height = inner if columns == COLUMNS else max(44.0, inner * (ratio + 0.06))
    parts = []
    for k, record in enumerate(records):
        north, east = extents([record])
        view = TrackView(is_rotated=is_slender([record]) and north > east)
        panel = equal_scale_panel([record], view, length, (tile * k + LEFT, top + TOP, inner, height))
        y_ticks = 2 if columns == STRIP_COLUMNS else 4
        parts.append(axes(panel, title=record.name.removeprefix(prefix), y_ticks=y_ticks, x_ticks=4))
        parts.append(track_svg(panel, view, record, length, PLAIN))
    return parts, top + height + TOP + BELOW


def overlay(prediction: Prediction, length: float, top: float, panel_width: float) -> tuple[str, float, bool]:
    """Measured and simulated track in one panel of width `room`; the parts, their height, and whether it is a strip.

    Long and narrow tracks become a strip as wide as the page.
    """
    measured, simulated = prediction.measured, prediction.simulated
    both = [measured, simulated]
    north, east = extents(both)
    slender = is_slender(both)
    view = TrackView(is_rotated=slender and north > east)
    width = (WIDTH - LEFT - 8) if slender else panel_width - LEFT - 8
    height = max(60.0, width * (min(north, east) + length) / (max(north, east) + length)) if slender else width
    panel = equal_scale_panel(both, view, length, (LEFT, top, width, height))
    names = ("x₀, north [m]", "y₀, east [m]") if view.is_rotated else ("y₀, east [m]", "x₀, north [m]")
    parts = [
        axes(panel, x_label=names[0], y_label=names[1], x_ticks=9 if slender else 5, y_ticks=3 if slender else 5),
        _envelope(panel, view, prediction),
        track_svg(panel, view, measured, length, MEASURED, fill="#d4d4d4"),
        track_svg(panel, view, simulated, length, SIMULATED),
    ]
    return "".join(parts), height + 48.0, slender


def _envelope(panel: Panel, view: TrackView, prediction: Prediction) -> str:
    """The 95 % band of the simulated track; empty without half widths."""
    north, east = (prediction.half_width.get(s) for s in ("x0", "y0"))
    if north is None or east is None:
        return ""
    halves = (north, east) if view.is_rotated else (east, north)
    simulated = prediction.simulated
    return bands.along_track(panel, view.horizontal(simulated), view.vertical(simulated), halves)


def equal_scale_panel(
    records: Sequence[Record], view: TrackView, length: float, box: tuple[float, float, float, float]
) -> Panel:
    """A panel in the box that shows all tracks at equal scales."""
    left, top, width, height = box
    x = _widened(span([view.horizontal(r) for r in records], 0.0), length)
    y = _widened(span([view.vertical(r) for r in records], 0.0), length)
    scale = max((x[1] - x[0]) / width, (y[1] - y[0]) / height)
    return Panel(left, top, width, height, _centred(x, scale * width), _centred(y, scale * height), view.is_rotated)


def _widened(ends: tuple[float, float], length: float) -> tuple[float, float]:
    room = 0.6 * length + 0.03 * (ends[1] - ends[0])
    return ends[0] - room, ends[1] + room


def _centred(ends: tuple[float, float], size: float) -> tuple[float, float]:
    middle = 0.5 * (ends[0] + ends[1])
    return middle - 0.5 * size, middle + 0.5 * size


def track_svg(panel: Panel, view: TrackView, record: Record, length: float, stroke: Stroke, fill: str = "none") -> str:
    """One track, with ships where the heading is known."""
    parts = [panel.curve(*thinned(view.horizontal(record), view.vertical(record)), stroke)]
    if "psi" in record and length > 0:
        outline_stroke = Stroke(stroke.colour if fill == "none" else "#9a9a9a", 0.8)
        for i in np.linspace(0, len(record) - 1, SHIPS).astype(int):
            north, east = hull_outline(
                float(record["x0"][i]), float(record["y0"][i]), float(record["psi"][i]), length
            ).T
            across, along = (north, east) if view.is_rotated else (east, north)
            parts.append(path(panel.px(across), panel.py(along), outline_stroke, fill))
    return "".join(parts)


def hull_outline(north: float, east: float, heading: float, length: float) -> Array:
    """Outline of the ship, shape (n, 2): north, east [m]; heading [rad]."""
    c, s = math.cos(heading), math.sin(heading)
    return _OUTLINE @ np.array([[c, s], [-s, c]]) * length + [north, east]
