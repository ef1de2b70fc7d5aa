"""Charts as SVG text that scales with the page; a report of three hundred panels takes a fraction of a second."""

import html

import numpy as np
from numpy.typing import NDArray

from seatrial.core.figures.chart import Chart, LegendPosition, Panel, Region
from seatrial.core.figures.marks import (
    INK,
    TEXT_SIZE,
    Anchor,
    Area,
    Array,
    Line,
    Mark,
    Marker,
    Points,
    Rectangle,
    Rule,
    Shape,
    Stroke,
    Text,
)
from seatrial.core.figures.svg_path import path_data

FONT = "Arial, Helvetica, 'Liberation Sans', 'DejaVu Sans', sans-serif"
GRID, AXIS = Stroke("#ececec", 0.8), Stroke("#8a9299", 0.8)  # px, chosen
# a point this far outside the panel still belongs to it [px]
EDGE = 0.5
# corners of markers relative to their size, closed
_CORNERS = {
    Shape.DIAMOND: ((0, -1.35), (1.35, 0), (0, 1.35), (-1.35, 0)),
    Shape.SQUARE: ((-1, -1), (1, -1), (1, 1), (-1, 1)),
    Shape.UP: ((0, -1.25), (1.2, 0.95), (-1.2, 0.95)),
    Shape.DOWN: ((0, 1.25), (1.2, -0.95), (-1.2, -0.95)),
    Shape.RIGHT: ((1.25, 0), (-0.95, 1.2), (-0.95, -1.2)),
}


def svg(chart: Chart | None) -> str:
    """Return the chart as one SVG element; nothing for no chart."""
    if chart is None:
        return ""
    shift = chart.legend_height()
    panels = "".join(_panel(panel) for panel in chart.panels)
    content = f'<g transform="translate(0 {shift:g})">{panels}</g>' if shift else panels
    legend = "".join(_legend_entry(position) for position in chart.legend_positions())
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {chart.width:.0f} {chart.height():.0f}" '
        f'width="{chart.width:.0f}" role="img" '
        f'aria-label="{html.escape(chart.title)}" font-family="{FONT}">{legend}{content}</svg>'
    )


def _legend_entry(position: LegendPosition) -> str:
    sample, x, y = position.entry.sample, position.left, position.top + 6.0  # px, chosen
    if isinstance(sample, Stroke):
        shape = _segment(x, y, x + position.entry.sample_width - 6.0, y, sample)  # px, chosen
    elif isinstance(sample, Marker):
        shape = _markers(np.array([x + 6.0]), np.array([y]), sample)  # px, chosen
    else:
        shape = _rectangle(x, y - 5.5, 11.0, 11.0, sample)  # px, chosen
    return shape + _text(x + position.entry.sample_width, y + 4.0, position.entry.words)


def _panel(panel: Panel) -> str:
    return (_axes(panel) if panel.has_frame else "") + "".join(_mark(panel, mark) for mark in panel.marks)


def _axes(panel: Panel) -> str:
    """Grid, axis lines, texts of the ticks, names and title."""
    box, size = panel.box, panel.tick_size
    middle = 0.36 * size  # from the middle of a letter to its base line
    is_turned, parts = panel.has_turned_labels(), [_grid(panel)]
    for tick in panel.x.tick_list():
        x = float(panel.px(tick.value))
        if panel.x.has_labels and is_turned:
            parts.append(_text(x + middle, box.bottom + 6.0, tick.text, Anchor.END, size, turn=-90.0))  # px, chosen
        elif panel.x.has_labels:
            parts.append(_text(x, box.bottom + size + 3.0, tick.text, Anchor.MIDDLE, size))
    for tick in panel.y.tick_list():
        y = float(panel.py(tick.value))
        # px, chosen
        parts.append(_text(box.left - 5.0, y + middle, tick.text, Anchor.END, size) if panel.y.has_labels else "")
    if panel.has_lines:
        parts.append(_segment(box.left, box.top, box.left, box.bottom, AXIS))
        parts.append(_segment(box.left, box.bottom, box.right, box.bottom, AXIS))
    if panel.x.name:
        parts.append(_text(box.left + box.width / 2, box.bottom + panel.depth() - 1.0, panel.x.name, Anchor.MIDDLE))
    if panel.y.name:
        # px, chosen
        parts.append(_text(box.left - 41.0, box.top + box.height / 2, panel.y.name, Anchor.MIDDLE, turn=-90.0))
    if panel.title:
        parts.append(_text(box.left, box.top - 7.0, panel.title))  # px, chosen
    return "".join(parts)


def _grid(panel: Panel) -> str:
    """All grid lines as one path."""
    box, steps = panel.box, ""
    if panel.x.has_grid:
        steps += "".join(f"M{panel.px(t.value):.1f} {box.top:.1f}v{box.height:.1f}" for t in panel.x.tick_list())
    if panel.y.has_grid:
        steps += "".join(f"M{box.left:.1f} {panel.py(t.value):.1f}h{box.width:.1f}" for t in panel.y.tick_list())
    return f'<path d="{steps}" fill="none"{_stroke(GRID)}/>' if steps else ""


def _mark(panel: Panel, mark: Mark) -> str:
    box = panel.box
    match mark:
        case Line():
            return _clipped_path(panel, panel.px(mark.x), panel.py(mark.y), mark.stroke)
        case Points():
            px, py = panel.px(mark.x), panel.py(mark.y)
            inside = _is_inside(box, px, py)
            return _markers(px[inside], py[inside], mark.marker)
        case Area():
            px, py = panel.px(mark.x), panel.py(mark.y)
            finite = np.isfinite(px) & np.isfinite(py)
            if finite.sum() < 3:
                return ""
            return _clipped_path(panel, px[finite], py[finite], mark.stroke or Stroke("none", 0.0), mark.fill)
        case Rectangle():
            x = np.sort(panel.px(np.array([mark.left, mark.right])))
            y = np.sort(panel.py(np.array([mark.bottom, mark.top])))
            return _rectangle(x[0], y[0], x[1] - x[0] - mark.gap, y[1] - y[0] - mark.gap, mark.fill, mark.edge)
        case Rule():
            if mark.is_vertical:
                x = float(panel.px(mark.value))
                return _segment(x, box.top, x, box.bottom, mark.stroke)
            y = float(panel.py(mark.value))
            return _segment(box.left, y, box.right, y, mark.stroke)
        case Text():
            x, y = float(panel.px(mark.x)) + mark.dx, float(panel.py(mark.y)) + mark.dy
            return _text(x, y, mark.words, mark.anchor, mark.size, mark.colour, mark.turn)


def _is_inside(box: Region, px: Array, py: Array) -> NDArray[np.bool_]:
    across = (px >= box.left - EDGE) & (px <= box.right + EDGE)
    return across & (py >= box.top - EDGE) & (py <= box.bottom + EDGE)


def _clipped_path(panel: Panel, px: Array, py: Array, stroke: Stroke, fill: str = "none") -> str:
    """Path that ends at the edges of the panel."""
    box, path = panel.box, _path(px, py, stroke, fill)
    if not path or (_is_inside(box, px, py) | np.isnan(px) | np.isnan(py)).all():
        return path
    x, y, width, height = (f"{v:.1f}" for v in (box.left, box.top, box.width, box.height))
    return f'<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">{path}</svg>'


def _path(px: Array, py: Array, stroke: Stroke, fill: str = "none") -> str:
    """Line through positions in px; NaN leaves a gap."""
    steps = path_data(px, py)
    return f'<path d="{steps}" fill="{fill}"{_stroke(stroke)} stroke-linejoin="round"/>' if steps else ""


def _stroke(stroke: Stroke) -> str:
    dash = f' stroke-dasharray="{stroke.dash}"' if stroke.dash else ""
    return f' stroke="{stroke.colour}" stroke-width="{stroke.width:g}"{dash}'


def _segment(x1: float, y1: float, x2: float, y2: float, stroke: Stroke) -> str:
    return f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" fill="none"{_stroke(stroke)}/>'


def _rectangle(x: float, y: float, width: float, height: float, fill: str, edge: Stroke | None = None) -> str:
    border = _stroke(edge) if edge else ""
    size = f'width="{max(width, 0.0):.1f}" height="{max(height, 0.0):.1f}"'
    return f'<rect x="{x:.1f}" y="{y:.1f}" {size} fill="{fill}"{border}/>'


def _markers(px: Array, py: Array, marker: Marker) -> str:
    """One path for all positions."""
    steps = "".join(_outline(marker.shape, x, y, marker.size) for x, y in zip(px, py, strict=True))
    return f'<path d="{steps}" fill="{marker.fill}"{_stroke(Stroke(marker.edge, marker.edge_width))}/>' if steps else ""


def _outline(shape: Shape, x: float, y: float, s: float) -> str:
    match shape:
        case Shape.CIRCLE:
            return f"M{x - s:.1f} {y:.1f}a{s:g} {s:g} 0 1 0 {2 * s:g} 0a{s:g} {s:g} 0 1 0 {-2 * s:g} 0"
        case Shape.CROSS:
            return f"M{x - s:.1f} {y - s:.1f}l{2 * s:g} {2 * s:g}m0 {-2 * s:g}l{-2 * s:g} {2 * s:g}"
        case Shape.PLUS:
            return f"M{x - s:.1f} {y:.1f}h{2 * s:g}m{-s:g} {-s:g}v{2 * s:g}"
        case Shape.UPRIGHT:
            return f"M{x:.1f} {y - s:.1f}v{2 * s:g}"
        case _:
            corners = (f"{x + s * a:.1f} {y + s * b:.1f}" for a, b in _CORNERS[shape])
            return f"M{'L'.join(corners)}Z"


def _text(x: float, y: float, words: str, anchor: Anchor = Anchor.START, size: float = TEXT_SIZE, colour: str = INK,
          turn: float = 0.0) -> str:  # fmt: skip
    turned = f' transform="rotate({turn:g} {x:.1f} {y:.1f})"' if turn else ""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size:g}" fill="{colour}"{turned}>'
        f"{html.escape(words)}</text>"
    )
