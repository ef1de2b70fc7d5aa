"""Residuals of every channel: over the samples, their autocorrelation with a 95 % band, and against the normal."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.plot import (
    ACCENT,
    PLAIN,
    SECOND,
    Panel,
    Stroke,
    axes,
    channel_si_unit,
    decimated,
    drawing,
    label,
    rectangle,
    segment,
    span,
    text,
)  # fmt: skip
from seatrial.core.results import Residuals
from seatrial.core.values import Array, display_unit

BINS, WIDEST, HEIGHT, GAP = 41, 4.5, 76.0, 26.0
STEMS = 60


def whiteness(residuals: Sequence[Residuals]) -> str:
    """One row for each channel; empty where there are no residuals."""
    usable = [r for r in residuals if np.isfinite(r.values).sum() > 2]
    parts = []
    for k, one in enumerate(usable):
        top, last = 26 + k * (HEIGHT + GAP), k == len(usable) - 1
        parts.append(_series(one, top, last=last))
        parts.append(_autocorrelation(one, top, last=last))
        parts.append(_histogram(one.values[np.isfinite(one.values)], top, last=last))
    if not parts:
        return ""
    parts += [
        text(66, 14, "residual"),
        text(446, 14, "autocorrelation, 95 % band"),
        text(700, 14, "against the normal"),
    ]
    return drawing(parts, 26 + len(usable) * (HEIGHT + GAP) + 20, "residuals, their autocorrelation and histogram")


def _series(one: Residuals, top: float, *, last: bool) -> str:
    unit = channel_si_unit(one.channel)
    values = one.values * display_unit(unit)[0]
    at = np.arange(len(values), dtype=float)
    panel = Panel(66, top, 320, HEIGHT, (0.0, float(max(1, len(values) - 1))), span([values]))
    drawn = axes(panel, x_ticks=4, y_ticks=3, x_label="sample" if last else "", y_label=label(one.channel, unit))
    return drawn + panel.curve(*decimated(at, values, 500), Stroke(PLAIN.colour, 0.6))


def _autocorrelation(one: Residuals, top: float, *, last: bool) -> str:
    """Band +-1.96 / sqrt(n) of white residuals (Box, Jenkins & Reinsel 2008, section 2.1.6)."""
    band = 1.96 / np.sqrt(np.isfinite(one.values).sum())
    rho = one.autocorrelation
    lags = np.arange(len(rho)) / one.rate
    low = min(-0.25, float(np.nanmin(rho)) - 0.05) if len(rho) else -0.25
    panel = Panel(446, top, 210, HEIGHT, (-0.02 * lags[-1], lags[-1] * 1.02 or 1.0), (low, 1.05))
    parts = [axes(panel, x_ticks=4, y_ticks=3, x_label="lag [s]" if last else "")]
    edge = float(panel.py(band))
    parts.append(rectangle(panel.left_edge, edge, panel.width, float(panel.py(-band)) - edge, "#d9e4ec"))
    zero = float(panel.py(0))
    parts.append(segment(panel.left_edge, zero, panel.left_edge + panel.width, zero, Stroke("#999", 0.6)))
    if len(lags) <= STEMS:
        stems = zip(panel.px(lags), panel.py(rho), strict=True)
        parts += [segment(float(x), zero, float(x), float(y), Stroke(ACCENT, 1.6)) for x, y in stems]
    else:
        parts.append(panel.curve(*decimated(lags, rho), Stroke(ACCENT, 1.0)))
    return "".join(parts)


def _histogram(values: Array, top: float, *, last: bool) -> str:
    spread = float(np.std(values)) or 1.0
    scaled = np.clip((values - np.mean(values)) / spread, -WIDEST, WIDEST)
    density, edges = np.histogram(scaled, bins=np.linspace(-WIDEST, WIDEST, BINS), density=True)
    at = np.linspace(-WIDEST, WIDEST, 91)
    panel = Panel(700, top, 150, HEIGHT, (-WIDEST, WIDEST), (0.0, max(0.42, 1.05 * float(density.max()))))
    parts = [axes(panel, x_ticks=4, y_ticks=1, y_labels=False, x_label="residual / std. deviation" if last else "")]
    for height, first, second in zip(density, edges[:-1], edges[1:], strict=True):
        if height > 0:
            x, y = float(panel.px(first)), float(panel.py(height))
            parts.append(rectangle(x, y, float(panel.px(second)) - x, panel.top + panel.height - y, "#c9d3da"))
    normal = np.exp(-0.5 * at**2) / np.sqrt(2 * np.pi)
    return "".join([*parts, panel.curve(at, normal, Stroke(SECOND, 1.2, "4 2.5"))])
