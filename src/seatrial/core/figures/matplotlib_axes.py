"""Charts as Matplotlib figures, each panel as axes that can be changed further."""

from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.figures.chart import (
    TEXT_SIZE,
    Area,
    Array,
    Chart,
    LegendPosition,
    Line,
    Mark,
    Marker,
    Panel,
    Points,
    Rectangle,
    Rule,
    Shape,
    Stroke,
    Text,
)
from seatrial.core.figures.svg_text import AXIS, GRID

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D


# pixels of a chart for an inch of paper
DPI = 100.0
# points (1/72 inch), in which Matplotlib measures fonts and lines, of a pixel
POINT = 72.0 / DPI
# Matplotlib's letters of the shapes
_LETTERS = {
    Shape.CIRCLE: "o", Shape.CROSS: "x", Shape.PLUS: "+", Shape.DIAMOND: "D", Shape.SQUARE: "s", Shape.UP: "^",
    Shape.DOWN: "v", Shape.RIGHT: ">", Shape.UPRIGHT: "|",
}  # fmt: skip


def matplotlib_figure(chart: Chart) -> "Figure":
    """Return the chart as a new figure of pyplot: `show` displays it, `savefig` writes it."""
    from matplotlib import pyplot

    width, height, shift = chart.width, chart.height(), chart.legend_height()
    figure = pyplot.figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    for panel in chart.panels:
        box = panel.box
        place = (box.left / width, 1.0 - (box.bottom + shift) / height, box.width / width, box.height / height)
        _draw_panel(figure.add_axes(place), panel)
    for position in chart.legend_positions():
        _draw_legend_entry(figure, position, width, height)
    return figure


def _draw_panel(axes: "Axes", panel: Panel) -> None:
    for mark in panel.marks:
        _draw_mark(axes, mark)
    for axis, spec, scale, limits, ticks in (
        (axes.xaxis, panel.x, axes.set_xscale, axes.set_xlim, axes.set_xticks),
        (axes.yaxis, panel.y, axes.set_yscale, axes.set_ylim, axes.set_yticks),
    ):
        scale("log" if spec.is_logarithmic else "linear")
        listed = spec.tick_list()
        ticks([], minor=True)
        ticks([t.value for t in listed], [t.text if spec.has_labels else "" for t in listed])
        limits(*spec.ends)
        axis.set_label_text(spec.name, fontsize=TEXT_SIZE * POINT)
        axis.set_tick_params(length=0.0, labelsize=panel.tick_size * POINT)
        if spec.has_grid:
            axis.grid(color=GRID.colour, linewidth=GRID.width * POINT)
    if panel.has_turned_labels():
        axes.tick_params(axis="x", rotation=90.0)
    if panel.is_y_down:
        axes.invert_yaxis()
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set(color=AXIS.colour, linewidth=AXIS.width * POINT, visible=panel.has_lines)
    axes.set_title(panel.title, loc="left", fontsize=TEXT_SIZE * POINT, pad=5.0)  # px, chosen
    if not panel.has_frame:
        axes.set_axis_off()


def _draw_mark(axes: "Axes", mark: Mark) -> None:
    from matplotlib import patches

    match mark:
        case Line():
            axes.add_line(_line(mark.x, mark.y, mark.stroke))
        case Points():
            axes.add_line(_markers(mark.x, mark.y, mark.marker))
        case Area():
            edge = mark.stroke or Stroke("none", 0.0)
            finite = np.isfinite(mark.x) & np.isfinite(mark.y)
            axes.fill(
                mark.x[finite], mark.y[finite], facecolor=mark.fill, edgecolor=edge.colour, linewidth=edge.width * POINT
            )
        case Rectangle():
            corner = (mark.left, mark.bottom)
            axes.add_patch(
                patches.Rectangle(corner, mark.right - mark.left, mark.top - mark.bottom, facecolor=mark.fill,
                                  edgecolor=mark.edge.colour if mark.edge else "white",
                                  linewidth=(mark.edge.width if mark.edge else mark.gap) * POINT)
            )  # fmt: skip
        case Rule():
            along, value = np.array([0.0, 1.0]), np.full(2, mark.value)
            line = _line(*((value, along) if mark.is_vertical else (along, value)), mark.stroke)
            line.set_transform(axes.get_xaxis_transform() if mark.is_vertical else axes.get_yaxis_transform())
            axes.add_line(line)
        case Text():
            axes.annotate(
                mark.words, (mark.x, mark.y), (mark.dx * POINT, -mark.dy * POINT), textcoords="offset points",
                ha={"start": "left", "middle": "center", "end": "right"}[mark.anchor], va="baseline",
                fontsize=mark.size * POINT, color=mark.colour, rotation=-mark.turn, annotation_clip=False,
            )  # fmt: skip


def _draw_legend_entry(figure: "Figure", position: LegendPosition, width: float, height: float) -> None:
    entry, left, right = position.entry, position.left / width, (position.left + position.entry.sample_width) / width
    y = np.full(2, 1.0 - (position.top + 6.0) / height)  # px, chosen
    if isinstance(entry.sample, Stroke):
        sample = _line(np.array([left, right - 6.0 / width]), y, entry.sample)  # px, chosen
    else:
        # px, chosen
        marker = entry.sample if isinstance(entry.sample, Marker) else Marker(Shape.SQUARE, 5.5, "none", entry.sample)
        sample = _markers(np.array([left + 6.0 / width]), y[:1], marker)  # px, chosen
    figure.add_artist(sample)
    figure.text(right, y[0], entry.words, fontsize=TEXT_SIZE * POINT, va="center_baseline")


def _line(x: Array, y: Array, stroke: Stroke) -> "Line2D":
    from matplotlib.lines import Line2D

    dashes = tuple(float(length) / stroke.width for length in stroke.dash.split())
    return Line2D(x, y, color=stroke.colour, linewidth=stroke.width * POINT, linestyle=(0, dashes) if dashes else "-")


def _markers(x: Array, y: Array, marker: Marker) -> "Line2D":
    from matplotlib.lines import Line2D

    return Line2D(x, y, linestyle="none", marker=_LETTERS[marker.shape], markersize=2.0 * marker.size * POINT,
                  markerfacecolor=marker.fill, markeredgecolor=marker.edge,
                  markeredgewidth=marker.edge_width * POINT)  # fmt: skip
