"""Charts of records: channels, residuals, and the parts of a log."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.chart import (
    ACCENT,
    INK,
    SECOND,
    WIDTH,
    Array,
    Axis,
    Chart,
    Line,
    Mark,
    Panel,
    Rectangle,
    Region,
    Rule,
    Stroke,
    decimated,
    tiles,
)
from seatrial.core.figures.run import ChannelPanel, RunView, TimeCurve, Track, is_slender, strip_height, track_panel
from seatrial.core.results import Residuals
from seatrial.core.text.words import common_prefix
from seatrial.core.values import Record, display_unit
from seatrial.core.values.notation import channel_label, channel_letter, channel_unit
from seatrial.core.values.record_chart import PLAIN, has_track, record_track
from seatrial.reporting.time_figures import run_figure

# All records of a fit as small multiples: channels over time, and tracks.

# channels and records of one figure at most
MAX_COLUMNS, MAX_ROWS = 8, 16
# tracks in a row: square ones, and strips; free room above, between and beside them [px]
COLUMNS, STRIP_COLUMNS = 4, 2
TOP, ROW_GAP, LEFT, RIGHT = 22.0, 56.0, 52.0, 12.0  # px, chosen
MIN_STRIP = 44.0  # px, chosen
SMALL = 8.5  # px, chosen


def track_overview(records: Sequence[Record], length: float) -> Chart | None:
    """Return small multiples of all tracks, strips first; None where no record has positions.

    Args:
        length: of the ship [m].
    """
    prefix = common_prefix([r.name for r in records])
    named = [(r.name.removeprefix(prefix), record_track(r, PLAIN)) for r in records if has_track(r)]
    strips = [(name, track) for name, track in named if is_slender([track])]
    squares = [(name, track) for name, track in named if not is_slender([track])]
    panels = _track_rows(strips, length, 0.0, STRIP_COLUMNS)
    bottom = panels[-1].box.bottom + ROW_GAP - TOP if panels else 0.0
    panels += _track_rows(squares, length, bottom, COLUMNS)
    return Chart("tracks of the records", tuple(panels)) if panels else None


def _track_rows(tracks: Sequence[tuple[str, Track]], length: float, top: float, columns: int) -> list[Panel]:
    """Rows of tracks below `top`, strips as high as the widest of their row needs."""
    inner, panels = WIDTH / columns - LEFT - RIGHT, []
    for k in range(0, len(tracks), columns):
        row = tracks[k : k + columns]
        is_strip = columns == STRIP_COLUMNS
        # px, chosen
        height = max(MIN_STRIP, *(strip_height([t], inner, 0.06 * inner) for _, t in row)) if is_strip else inner
        for j, (name, track) in enumerate(row):
            box = Region(WIDTH / columns * j + LEFT, top + TOP, inner, height)
            panels.append(track_panel([track], length, box, has_names=False, x_ticks=4, y_ticks=2 if is_strip else 4,
                                      title=name))  # fmt: skip
        top += height + ROW_GAP
    return panels


# Residuals of every channel: over the samples, their autocorrelation with a 95 % band, and against the normal.

# bars of the histogram, its reach in standard deviations, and the density of the normal at zero
BINS, WIDEST, NORMAL_PEAK = 41, 4.5, 0.42
HEIGHT = 76.0  # px, chosen
# lags up to which the autocorrelation is drawn as stems
MAX_STEMS = 60
# quantile of the standard normal distribution for 95 %, two-sided
NORMAL_95 = 1.96


def residual_series(residuals: Sequence[Residuals]) -> Markup:
    """Return the residuals of every channel over the samples; empty where there are none."""
    usable = _usable(residuals)
    panels = tuple(_series(r) for r in usable)
    return run_figure(RunView("residuals", panels), x_label="sample") if panels else Markup()


def whiteness_chart(residuals: Sequence[Residuals]) -> Chart | None:
    """Return autocorrelation and histogram of the residuals of each channel; None where there are none."""
    usable = _usable(residuals)
    boxes = tiles(2 * len(usable), 4, HEIGHT, left=46.0, right=14.0, gap=52.0, top=22.0)  # px, chosen
    panels = [
        panel
        for k, r in enumerate(usable)
        for panel in (
            replace(_autocorrelation(r, boxes[2 * k]), title=f"{channel_letter(r.channel)}: autocorrelation"),
            replace(_histogram(r.values[np.isfinite(r.values)], boxes[2 * k + 1]), title="against the normal"),
        )
    ]
    return Chart("autocorrelation and histogram of the residuals", tuple(panels)) if panels else None


def _usable(residuals: Sequence[Residuals]) -> list[Residuals]:
    return [r for r in residuals if np.isfinite(r.values).sum() > 2]


def _series(r: Residuals) -> ChannelPanel:
    unit = channel_unit(r.channel)
    samples = np.arange(len(r.values), dtype=float)
    curve = TimeCurve(samples, r.values * display_unit(unit)[0], Stroke(INK, 0.6), "residual")  # px, chosen
    return ChannelPanel(channel_label(r.channel, unit), (curve,))


def _autocorrelation(r: Residuals, box: Region) -> Panel:
    """Band +-1.96 / sqrt(n) of white residuals (Region, Jenkins & Reinsel 2008, section 2.1.6)."""
    edge = NORMAL_95 / np.sqrt(np.isfinite(r.values).sum())
    rho, lags = r.autocorrelation, np.arange(len(r.autocorrelation)) / r.rate
    low = min(-0.25, float(np.nanmin(rho)) - 0.05) if len(rho) else -0.25  # px, chosen
    x = Axis((-0.02 * lags[-1], lags[-1] * 1.02 or 1.0), "lag [s]", tick_count=4)  # px and ticks, chosen
    # px, chosen
    marks: list[Mark] = [Rectangle(x.ends[0], -edge, x.ends[1], edge, "#d9e4ec"), Rule(0.0, Stroke("#999999", 0.6))]
    if len(lags) <= MAX_STEMS:
        stems = [np.array([lag, lag, np.nan]) for lag in lags], [np.array([0.0, value, np.nan]) for value in rho]
        marks.append(Line(np.concatenate(stems[0]), np.concatenate(stems[1]), Stroke(ACCENT, 1.6)))  # px, chosen
    else:
        marks.append(Line(*decimated(lags, rho), Stroke(ACCENT, 1.0)))
    return Panel(box, x, Axis((low, 1.05), tick_count=3), tuple(marks))  # px and ticks, chosen


def _histogram(values: Array, box: Region) -> Panel:
    spread = float(np.std(values)) or 1.0
    scaled = np.clip((values - np.mean(values)) / spread, -WIDEST, WIDEST)
    density, edges = np.histogram(scaled, bins=np.linspace(-WIDEST, WIDEST, BINS), density=True)
    marks: list[Mark] = [
        Rectangle(left, 0.0, right, height, "#c9d3da")
        for height, left, right in zip(density, edges[:-1], edges[1:], strict=True)
        if height > 0
    ]
    z = np.linspace(-WIDEST, WIDEST, 91)  # points of a curve, chosen
    marks.append(Line(z, np.exp(-0.5 * z**2) / np.sqrt(2 * np.pi), Stroke(SECOND, 1.2, "4 2.5")))  # px, chosen
    # px and ticks, chosen
    y = Axis((0.0, max(NORMAL_PEAK, 1.05 * float(density.max()))), tick_count=1, has_labels=False)
    return Panel(box, Axis((-WIDEST, WIDEST), "residual / std. deviation", tick_count=4), y, tuple(marks))
