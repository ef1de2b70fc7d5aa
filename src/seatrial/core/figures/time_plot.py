"""Time series for a page that draws them itself: one grid for all curves, few points that keep every extreme, 16 bits.

The page's script (`seatrial/reporting/templates/plots.js`) reads what `plot_document` returns."""

import base64
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from seatrial.core.figures.chart import Array, Stroke, span
from seatrial.core.figures.run import ChannelPanel, TimeCurve, visible_edges

# points of a curve: as many as a panel of a page has pixels for extremes; of a band's edge, which is smooth
POINTS, BAND_POINTS = 500, 120
# codes of 16 bits: the largest of a value, and the one of a gap
LARGEST_CODE, GAP_CODE = 65534, 65535
# difference of two times [s] that is rounding
TIME_ROUNDING = 1e-9
# digits of the ends of a range: finer than 16 bits
RANGE_DIGITS = 7


def plot_document(channels: Sequence[ChannelPanel], *, x_label: str = "t [s]") -> dict[str, Any]:
    """Return the panels of a figure over one time axis, ready for JSON.

    Curves on another time base than the first one are interpolated to its samples; outside of them is a gap.
    """
    base = channels[0].curves[0].time
    count = min(len(base), POINTS)
    first, last = (float(base[0]), float(base[-1])) if len(base) else (0.0, 1.0)
    return {
        "x": x_label,
        "start": _short(first),
        "stop": _short(last if last > first else first + 1.0),
        "count": count,
        "panels": [_panel(channel, base) for channel in channels],
    }


def grid_values(time: Array, values: Array, points: int = POINTS) -> Array:
    """Return values on an even grid of at most `points`: all of them, or least and largest of each stretch in order."""
    if len(time) <= points:
        return values
    edges = np.linspace(0, len(time), points // 2 + 1).astype(int)
    low, high = np.where(np.isnan(values), np.inf, values), np.where(np.isnan(values), -np.inf, values)
    first, last = edges[:-1, None], edges[1:, None] - 1
    places = np.minimum(first + np.arange(np.max(np.diff(edges))), last)  # of each stretch, the last one repeated
    extremes = first + np.stack([low[places].argmin(axis=1), high[places].argmax(axis=1)], axis=1)
    return values[np.sort(extremes, axis=1).ravel()]


def packed(values: Array) -> dict[str, Any]:
    """Return values as base64 of 16-bit numbers, little-endian, between the ends of their range; gaps have a code."""
    finite = np.isfinite(values)
    low, high = (float(values[finite].min()), float(values[finite].max())) if finite.any() else (0.0, 0.0)
    low, high = _short(low), _short(high)
    width = (high - low) or 1.0
    codes = np.full(len(values), GAP_CODE, dtype="<u2")
    shares = np.clip((values[finite] - low) / width, 0.0, 1.0)
    codes[finite] = np.round(shares * LARGEST_CODE).astype("<u2")
    return {"range": [low, high], "codes": base64.b64encode(codes.tobytes()).decode("ascii")}


def _panel(channel: ChannelPanel, base: Array) -> dict[str, Any]:
    curves = [_on_base(curve, base) for curve in channel.curves]
    curves_and_edges = list(curves)
    panel: dict[str, Any] = {"label": channel.label}
    if channel.lower is not None and channel.upper is not None:
        edges = visible_edges(curves, channel.lower, channel.upper)
        curves_and_edges += edges
        kept = np.unique(np.linspace(0, len(base) - 1, min(BAND_POINTS, len(base))).astype(int))
        panel["band"] = [packed(edge[kept]) for edge in edges]
    levels = [rule.value for rule in channel.limits]
    ends = channel.ends or span([*curves_and_edges, np.array(levels, float)])
    panel["ends"] = [_short(end) for end in ends]
    panel["curves"] = [
        {"name": curve.name, "stroke": _stroke(curve.stroke), **packed(grid_values(base, values))}
        for curve, values in zip(channel.curves, curves, strict=True)
    ]
    panel["levels"] = [{"value": _short(rule.value), "stroke": _stroke(rule.stroke)} for rule in channel.limits]
    return panel


def _on_base(curve: TimeCurve, base: Array) -> Array:
    if len(curve.time) == len(base) and np.allclose(curve.time, base, rtol=0.0, atol=TIME_ROUNDING):
        return curve.values
    return np.interp(base, curve.time, curve.values, left=math.nan, right=math.nan)


def _stroke(stroke: Stroke) -> list[Any]:
    return [stroke.colour, stroke.width, [float(part) for part in stroke.dash.split()]]


def _short(value: float) -> float:
    return float(f"{value:.{RANGE_DIGITS}g}")
