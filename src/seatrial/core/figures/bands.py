"""Bands of 95 % about a simulated run: over time, and as an envelope along its track."""

import numpy as np

from seatrial.core.figures.plot import Panel, Stroke, clipped, path, thinned
from seatrial.core.results import Prediction
from seatrial.core.values import Array, display_unit

BAND = "#1b4f7230"
SAMPLE = Stroke(BAND, 9.0)
POINTS = 120
WIDEST = 1.0
_NONE = Stroke("none", 0.0)


def has_band(prediction: Prediction) -> bool:
    """Whether any channel has one."""
    return any(np.isfinite(half).any() for half in prediction.half_width.values())


def edges(values: Array, half_width: Array, unit: str) -> tuple[Array, Array]:
    """Lower and upper edge about `values`, which are in the unit people read; the half width is in SI."""
    half = half_width * display_unit(unit)[0]
    return values - half, values + half


def visible_edges(curves: list[Array], band: tuple[Array, Array]) -> list[Array]:
    """The band's edges as far as the axes should follow them: no further than the curves' own span beyond it."""
    known = np.concatenate([c[np.isfinite(c)] for c in curves])
    if known.size == 0:
        return []
    reach = WIDEST * (float(known.max() - known.min()) or 1.0)
    return [np.clip(edge, known.min() - reach, known.max() + reach) for edge in band]


def over_time(panel: Panel, time: Array, band: tuple[Array, Array]) -> str:
    """The band as a pale area; it ends at the panel's edges."""
    at, low = thinned(time, band[0], POINTS)
    high = thinned(time, band[1], POINTS)[1]
    return _area(panel, np.column_stack([at, low]), np.column_stack([at, high]))


def along_track(panel: Panel, across: Array, along: Array, halves: tuple[Array, Array]) -> str:
    """Envelope to both sides of a track.

    The half width to the side is that of an ellipse with the half widths of both coordinates as axes, seen along the
    track: h_n = sqrt((n_x h_x)^2 + (n_y h_y)^2) with n the unit normal.
    """
    kept = np.unique(np.linspace(0, len(across) - 1, min(POINTS, len(across))).astype(int))
    x, y = across[kept], along[kept]
    if len(kept) < 3:
        return ""
    step = np.column_stack([np.gradient(x), np.gradient(y)])
    lengths = np.hypot(*step.T)
    normal = np.column_stack([-step[:, 1], step[:, 0]]) / np.where(lengths > 0, lengths, 1.0)[:, None]
    half = np.hypot(normal[:, 0] * halves[0][kept], normal[:, 1] * halves[1][kept])
    middle = np.column_stack([x, y])
    sides = [middle + sign * normal * half[:, None] for sign in (-1.0, 1.0)]
    return _area(panel, *sides)


def _area(panel: Panel, one_edge: Array, other_edge: Array) -> str:
    """The closed area between two lines, shape (n, 2) each; places without a value are left out."""
    known = np.isfinite(one_edge).all(axis=1) & np.isfinite(other_edge).all(axis=1)
    outline = np.vstack([one_edge[known], other_edge[known][::-1]])
    drawn = path(panel.px(outline[:, 0]), panel.py(outline[:, 1]), _NONE, BAND)
    return clipped(panel, drawn) if known.sum() > 1 else ""
