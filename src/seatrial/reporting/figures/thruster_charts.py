"""Thrust over command with its band and where the commands were; compass deviation over heading."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    INK,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Panel,
    Rectangle,
    Rule,
    Stroke,
    span,
    tiles,
)
from seatrial.core.figures.run import band, visible_edges
from seatrial.core.results.ship_motions import CommandCurve, CompassCurve, QuadrantMap

COLUMNS, HEIGHT = 2, 230.0  # panels in a row; px, chosen
_STILL, _MOVING, _ZERO = Stroke(INK, 1.5), Stroke(ACCENT, 1.4, "5 3"), Stroke("#999999", 0.8)  # px, chosen
_TIME, _TRAINED, _NEW = "#c9d2d9", "#a9bccb", "#d98c76"
_HELD_OUT = Stroke(INK, 0.8)  # px, chosen
_TALLEST = 0.2
"""Height of the highest bar of time, as a share of the panel's; chosen."""


def thrust_chart(curves: Sequence[CommandCurve], unit: str) -> Chart:
    """Return a panel for each set of coefficients: thrust at rest with its band, and at the speed of the runs."""
    columns = min(COLUMNS, len(curves))
    boxes = tiles(len(curves), columns, HEIGHT, left=58.0, right=12.0, top=20.0, gap=52.0)  # px, chosen
    panels = []
    for curve, box in zip(curves, boxes, strict=True):
        x, middle, moving = (np.array(values) for values in (curve.share, curve.thrust, curve.at_speed))
        low, high = np.array(curve.lower), np.array(curve.upper)
        ends = span([middle, moving, *visible_edges([middle, moving], low, high)])
        marks = (
            *_time_bars(np.array(curve.edges), np.array(curve.time_share), ends), Rule(0.0, _ZERO),
            band(x, low, high), Line(x, moving, _MOVING), Line(x, middle, _STILL),
        )  # fmt: skip
        axis = Axis((-1.0, 1.0), "share of full command")
        panels.append(Panel(box, axis, Axis(ends, f"thrust, {unit}"), marks, title=", ".join(curve.thrusters)))
    speed = curves[0].speed
    legend = (
        LegendEntry("in water at rest, 95 % band", _STILL), LegendEntry(f"at {speed:.2g} m/s ahead", _MOVING),
        LegendEntry("time with the command in the training runs", _TIME),
    )  # fmt: skip
    return Chart("thrust over command", tuple(panels), legend)


def quadrant_chart(maps: Sequence[QuadrantMap]) -> Chart:
    """Return a panel for each thruster: command over speed, cells of the training runs, those of runs held out."""
    columns = min(COLUMNS, len(maps))
    boxes = tiles(len(maps), columns, HEIGHT, left=58.0, right=12.0, top=20.0, gap=52.0)  # px, chosen
    panels = []
    for one, box in zip(maps, boxes, strict=True):
        y, x = one.speed_edges, one.order_edges
        cells = [(i, j) for i in range(len(x) - 1) for j in range(len(y) - 1)]
        marks: list[Mark] = []
        for i, j in cells:
            trained = one.training[i][j] > 0.0
            held = bool(one.held_out) and one.held_out[i][j] > 0.0
            fill = _TRAINED if trained else _NEW
            if trained or held:
                edge = _HELD_OUT if held else None
                marks.append(Rectangle(x[i], y[j], x[i + 1], y[j + 1], fill, gap=1.0, edge=edge))
        lines = (Rule(0.0, _ZERO), Rule(0.0, _ZERO, is_vertical=True))
        axes = Axis((-1.0, 1.0), "share of full command"), Axis((y[0], y[-1]), "speed along the thruster, m/s")
        panels.append(Panel(box, *axes, (*marks, *lines), title=one.thruster))
    legend = [LegendEntry("training runs", _TRAINED)]
    if any(one.held_out for one in maps):
        legend += [LegendEntry("held-out runs where no training run was", _NEW)]
    return Chart("commands and speeds of the thrusters", tuple(panels), tuple(legend))


def compass_chart(compass: CompassCurve) -> Chart:
    """Return the deviation [deg] over the heading shown, with its band and the headings of the training runs."""
    (box,) = tiles(1, 1, HEIGHT, left=58.0, right=12.0, top=8.0)  # px, chosen
    x, middle, low, high = (
        np.degrees(values) for values in (compass.heading, compass.deviation, compass.lower, compass.upper)
    )
    ends = span([middle, *visible_edges([middle], low, high)])
    edges = np.linspace(0.0, 360.0, len(compass.time_share) + 1)
    marks = (
        *_time_bars(edges, np.array(compass.time_share), ends), Rule(0.0, _ZERO), band(x, low, high),
        Line(x, middle, _STILL),
    )  # fmt: skip
    axis = Axis((0.0, 360.0), "heading shown, deg", tick_count=8)
    panel = Panel(box, axis, Axis(ends, "deviation, deg"), marks)
    legend = (
        LegendEntry("deviation with 95 % band", _STILL),
        LegendEntry("time with the heading in the training runs", _TIME),
    )  # fmt: skip
    return Chart("deviation of the compass", (panel,), legend)


def _time_bars(edges: Array, share: Array, ends: tuple[float, float]) -> list[Mark]:
    """Bars from the lower end of the axis; their heights follow the root, so that short times show too."""
    root = np.sqrt(share / max(float(np.max(share)), 1e-12))  # of shares that add up to 1
    tops = ends[0] + _TALLEST * (ends[1] - ends[0]) * root
    return [
        Rectangle(float(a), ends[0], float(b), float(top), _TIME, gap=1.0)
        for a, b, top in zip(edges[:-1], edges[1:], tops, strict=True)
        if top > ends[0]
    ]
