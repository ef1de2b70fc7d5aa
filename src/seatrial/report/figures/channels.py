"""Channels over time: all records as small multiples, and one run measured beside simulated."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from seatrial.report.figures.canvas import ACCENT, INK, MEASURED, canvas, decimated, label, shown, styled, svg
from seatrial.report.figures.tracks import has_track, overlay
from seatrial.results import Prediction
from seatrial.values import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ORDER = ("psi", "r", "u", "v", "delta", "n", "v_j", "thrust", "phi", "p", "wind_speed", "wind_direction")
POSITIONS = ("x0", "y0")
MOST_COLUMNS, MOST_ROWS = 7, 12


def ordered(record: Record) -> list[str]:
    """Channels in the order of reading, positions left out."""
    names = [s for s in record.channels if s not in POSITIONS]
    return sorted(names, key=lambda s: (ORDER.index(s) if s in ORDER else len(ORDER), s))


def overview(records: Sequence[Record], prefix: str) -> list[str]:
    """A row for each record, a column for each channel, at most `MOST_ROWS` rows to a figure."""
    names = list(dict.fromkeys(s for record in records for s in ordered(record)))
    names = sorted(names, key=lambda s: ORDER.index(s) if s in ORDER else len(ORDER))[:MOST_COLUMNS]
    if not names:
        return []
    return [
        _grid(records[k : k + MOST_ROWS], names, f"{prefix}{k}") for k in range(0, len(records), MOST_ROWS)
    ]


def _grid(records: Sequence[Record], names: Sequence[str], prefix: str) -> str:
    height = max(0.75, 1.3 - 0.1 * len(records))
    with styled():
        figure = canvas(height * len(records) + 0.45)
        grid = figure.subplots(len(records), len(names), squeeze=False, sharey="col")
        for row, record in zip(grid, records, strict=True):
            for axes, name in zip(row, names, strict=True):
                _small(axes, record, name)
            row[0].set_ylabel(record.name, rotation=0, ha="right", va="center")
        for axes, name in zip(grid[0], names, strict=True):
            unit = next(r.channel(name).unit for r in records if name in r) if any(name in r for r in records) else ""
            axes.set_title(label(name, unit), loc="left")
        for axes in grid[-1]:
            axes.set_xlabel("t [s]")
        return svg(figure, f"channels of {', '.join(r.name for r in records)}", prefix)


def _small(axes: "Axes", record: Record, name: str) -> None:
    axes.tick_params(labelsize=6)
    axes.locator_params(axis="y", nbins=3)
    axes.locator_params(axis="x", nbins=3)
    if name not in record:
        axes.text(0.5, 0.5, "not recorded", transform=axes.transAxes, ha="center", va="center", color="#888", size=6)
        return
    values = shown(name, record[name], record.channel(name).unit)
    axes.plot(*decimated(record.time, values, 240), color=INK, linewidth=0.7)


def comparison(prediction: Prediction, length: float, prefix: str) -> str:
    """Track and channels of one run, measured (broad, grey) and simulated (thin, dashed)."""
    measured, simulated = prediction.measured, prediction.simulated
    wanted = [s for s in ordered(measured) if s in simulated or s in ("delta", "n", "v_j")]
    names = [s for s in wanted if s in simulated or s == "delta"][:8]
    on_map = has_track(measured) and has_track(simulated)
    rows = max(1, -(-len(names) // 2))
    with styled():
        figure = canvas(max(1.25 * rows + 0.5, 3.2))
        grid = figure.add_gridspec(rows, 3 if on_map else 2, width_ratios=[1.25, 1, 1] if on_map else [1, 1])
        if on_map:
            overlay(figure.add_subplot(grid[:, 0]), measured, simulated, length)
        for k, name in enumerate(names):
            axes = figure.add_subplot(grid[k // 2, k % 2 + (1 if on_map else 0)])
            _pair(axes, measured, simulated, name)
            if k >= len(names) - 2:
                axes.set_xlabel("t [s]")
        _legend(figure.legend)
        return svg(figure, f"{prediction.record}: measured and simulated", prefix)


def _pair(axes: "Axes", measured: Record, simulated: Record, name: str) -> None:
    unit = measured.channel(name).unit
    axes.plot(*decimated(measured.time, shown(name, measured[name], unit)), color=MEASURED, linewidth=2.2)
    if name in simulated and name != "delta":
        values = shown(name, simulated[name], simulated.channel(name).unit)
        axes.plot(*decimated(simulated.time, values), color=ACCENT, linewidth=1.0, linestyle="--")
    axes.set_ylabel(label(name, unit))
    axes.locator_params(axis="y", nbins=5)
    axes.margins(x=0.01)


def _legend(place) -> None:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=MEASURED, linewidth=2.4, label="measured"),
        Line2D([], [], color=ACCENT, linewidth=1.1, linestyle="--", label="simulated, open loop"),
    ]
    place(handles=handles, loc="outside upper right", ncols=2)
