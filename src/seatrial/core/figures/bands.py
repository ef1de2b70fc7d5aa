"""Bands of 95 % about a curve: over time, and as an envelope along a track."""

import numpy as np

from seatrial.core.figures.marks import Area, Array
from seatrial.core.figures.ticks import thinned

# blue of the model, transparent to 19 %
BAND = "#1b4f7230"
POINTS = 120  # px, chosen
# how far axes follow a band beyond its curves, in spans of these
REACH = 1.0
# half width of an envelope, as a share of its track's larger extent, from which on it would hide the track; chosen
WIDEST_ENVELOPE = 0.25


def band(x: Array, lower: Array, upper: Array) -> Area:
    """Return the area between two curves over x."""
    x_kept, low = thinned(x, lower, POINTS)
    high = thinned(x, upper, POINTS)[1]
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


def track_envelope(x: Array, y: Array, half_x: Array, half_y: Array) -> Area | None:
    """Return the envelope to both sides of a track, up to where it is too wide to be read; None under three points.

    The half width to the side is that of an ellipse with the half widths of both coordinates as axes, seen along the
    track: h_n = sqrt((n_x h_x)^2 + (n_y h_y)^2) with n the unit normal.
    """
    kept = np.unique(np.linspace(0, len(x) - 1, min(POINTS, len(x))).astype(int))
    if len(kept) < 3:
        return None
    middle = np.column_stack([x[kept], y[kept]])
    step = np.gradient(middle, axis=0)
    lengths = np.hypot(step[:, 0], step[:, 1])
    normal = np.column_stack([-step[:, 1], step[:, 0]]) / np.where(lengths > 0, lengths, 1.0)[:, None]
    half = np.hypot(normal[:, 0] * half_x[kept], normal[:, 1] * half_y[kept])
    sides = [middle + sign * normal * half[:, None] for sign in (-1.0, 1.0)]
    is_too_wide = half > WIDEST_ENVELOPE * np.nanmax(np.nanmax(middle, axis=0) - np.nanmin(middle, axis=0))
    finite = (
        np.isfinite(sides[0]).all(axis=1) & np.isfinite(sides[1]).all(axis=1) & ~np.logical_or.accumulate(is_too_wide)
    )
    if finite.sum() < 3:
        return None
    outline = np.vstack([sides[0][finite], sides[1][finite][::-1]])
    return Area(outline[:, 0], outline[:, 1], BAND)
