"""Residuals of every channel: over the samples, their autocorrelation with a 95 % band, and against the normal."""

from collections.abc import Sequence

import numpy as np

from seatrial.report.figures.canvas import ACCENT, INK, SECOND, canvas, decimated, label, styled, svg
from seatrial.results import Residuals
from seatrial.values import Array, display

BINS, WIDEST = 41, 4.5


def whiteness(residuals: Sequence[Residuals], prefix: str) -> str:
    """One row for each channel; empty where there are no residuals."""
    usable = [r for r in residuals if np.isfinite(r.values).sum() > 2]
    if not usable:
        return ""
    with styled():
        figure = canvas(1.15 * len(usable) + 0.35)
        grid = figure.subplots(len(usable), 3, squeeze=False, width_ratios=[1.5, 1.1, 0.9])
        for row, one in zip(grid, usable, strict=True):
            _series(row[0], one)
            _autocorrelation(row[1], one)
            _histogram(row[2], one.values[np.isfinite(one.values)])
        for axes, title in zip(grid[0], ("residual", "autocorrelation, 95 % band", "against the normal"), strict=True):
            axes.set_title(title, loc="left")
        for axes, title in zip(grid[-1], ("sample", "lag [s]", "residual / its standard deviation"), strict=True):
            axes.set_xlabel(title)
        return svg(figure, "residuals, their autocorrelation and histogram", prefix)


def _unit(channel: str) -> str:
    from seatrial.values.notation import NOTATION

    return NOTATION[channel].unit if channel in NOTATION else "1"


def _series(axes, one: Residuals) -> None:
    factor = display(_unit(one.channel))[0]
    at = np.arange(len(one.values), dtype=float)
    axes.plot(*decimated(at, one.values * factor, 500), color=INK, linewidth=0.5)
    axes.set_ylabel(label(one.channel, _unit(one.channel)))
    axes.margins(x=0.01)
    axes.locator_params(nbins=4)


def _autocorrelation(axes, one: Residuals) -> None:
    """Band +-1.96 / sqrt(n) of white residuals (Box, Jenkins & Reinsel 2008, section 2.1.6)."""
    count = int(np.isfinite(one.values).sum())
    band = 1.96 / np.sqrt(count)
    lags = np.arange(len(one.autocorrelation)) / one.rate
    axes.axhspan(-band, band, color="#e3ebf1", linewidth=0)
    axes.axhline(0, color="#999999", linewidth=0.5)
    if len(lags) <= 60:
        axes.vlines(lags, 0, one.autocorrelation, color=ACCENT, linewidth=1.3)
    else:
        axes.plot(*decimated(lags, one.autocorrelation), color=ACCENT, linewidth=0.9)
    axes.set_ylim(min(-0.25, float(np.nanmin(one.autocorrelation)) - 0.05), 1.05)
    axes.margins(x=0.02)
    axes.locator_params(nbins=5)


def _histogram(axes, values: Array) -> None:
    spread = float(np.std(values)) or 1.0
    scaled = np.clip((values - np.mean(values)) / spread, -WIDEST, WIDEST)
    at = np.linspace(-WIDEST, WIDEST, 121)
    axes.hist(scaled, bins=np.linspace(-WIDEST, WIDEST, BINS).tolist(), density=True, color="#cfd8df", linewidth=0)
    axes.plot(at, np.exp(-0.5 * at**2) / np.sqrt(2 * np.pi), color=SECOND, linewidth=0.9, linestyle="--")
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
