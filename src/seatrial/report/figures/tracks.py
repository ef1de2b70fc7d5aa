"""Tracks: earth-fixed positions from above, north up; a little ship every so often shows the heading."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from seatrial.report.figures.canvas import ACCENT, INK, MEASURED, WIDTH, canvas, styled, svg, thinned
from seatrial.values import Array, Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMNS, ROWS, SHIPS = 4, 5, 7
# half a ship from above, in lengths: forward, starboard
_HULL = np.array([[0.5, 0], [0.3, 0.075], [-0.4, 0.075], [-0.5, 0.05]])
_OUTLINE = np.vstack([_HULL, _HULL[::-1] * [1, -1], _HULL[:1]])


def has_track(record: Record) -> bool:
    """Whether positions are there."""
    return {"x0", "y0"} <= set(record.channels)


def tracks(records: Sequence[Record], length: float, prefix: str) -> list[str]:
    """Small multiples of all tracks, at most `ROWS` rows to a figure."""
    usable = [r for r in records if has_track(r)]
    size = COLUMNS * ROWS
    return [_page(usable[k : k + size], length, f"{prefix}{k}") for k in range(0, len(usable), size)]


def _page(records: Sequence[Record], length: float, prefix: str) -> str:
    columns = min(COLUMNS, len(records))
    rows = math.ceil(len(records) / columns)
    width = WIDTH if columns > 2 else WIDTH * 0.38 * columns
    with styled():
        figure = canvas(rows * 1.95 + 0.15, width)
        for k, record in enumerate(records):
            axes = figure.add_subplot(rows, columns, k + 1)
            draw(axes, record, length, INK, "-", 1.0)
            axes.set_title(record.name, loc="left")
            square(axes)
        return svg(figure, f"tracks of {', '.join(r.name for r in records)}", prefix)


def overlay(axes: "Axes", measured: Record, simulated: Record, length: float) -> None:
    """Measured and simulated track in one picture."""
    draw(axes, measured, length, MEASURED, "-", 2.4, fill=True)
    draw(axes, simulated, length, ACCENT, "--", 1.1)
    square(axes)
    axes.set_xlabel("y₀, east [m]")
    axes.set_ylabel("x₀, north [m]")


def draw(
    axes: "Axes", record: Record, length: float, colour: str, style: str, width: float, *, fill: bool = False
) -> None:
    """One track with ships at equal times where the heading is known."""
    x, y = thinned(record["x0"], record["y0"], 600)
    axes.plot(y, x, color=colour, linestyle=style, linewidth=width)
    if "psi" not in record or not length > 0:
        return
    for i in np.linspace(0, len(record) - 1, SHIPS).astype(int):
        outline = hull(float(record["x0"][i]), float(record["y0"][i]), float(record["psi"][i]), length)
        if fill:
            axes.fill(outline[:, 1], outline[:, 0], color=colour, linewidth=0)
        else:
            axes.plot(outline[:, 1], outline[:, 0], color=colour, linewidth=0.7)


def hull(north: float, east: float, heading: float, length: float) -> Array:
    """Outline of the ship, shape (n, 2): north, east [m]; heading [rad]."""
    c, s = math.cos(heading), math.sin(heading)
    return _OUTLINE @ np.array([[c, s], [-s, c]]) * length + [north, east]


def square(axes: "Axes") -> None:
    """Equal scales, limits a square about the data."""
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_box_aspect(1)
    axes.locator_params(nbins=5)
