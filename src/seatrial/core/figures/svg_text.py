"""Charts as SVG text that scales with the page, with their colours for a dark screen; fast enough for hundreds."""

import colorsys
import html
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from seatrial.core.figures.chart import (
    INK,
    TEXT_SIZE,
    Anchor,
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
    Region,
    Rule,
    Shape,
    Stroke,
    Text,
)

# Colours of figures for a dark screen: the same hue, light and dark exchanged.

# largest value of a part of a colour, 8 bits
LARGEST_PART = 255
# lightness on a dark screen of what is black and of what is white: letters are not glaring, the ground is not black
LIGHTEST, DARKEST = 0.92, 0.11
# saturation that colours keep on a dark screen; chosen
SATURATION = 0.9


def night_colour(colour: str) -> str:
    """Return a colour `#rrggbb` or `#rrggbbaa` for a dark screen; the transparency stays."""
    red, green, blue = (part / LARGEST_PART for part in bytes.fromhex(colour[1:7]))
    hue, lightness, saturation = colorsys.rgb_to_hls(red, green, blue)
    channels = colorsys.hls_to_rgb(hue, LIGHTEST + (DARKEST - LIGHTEST) * lightness, SATURATION * saturation)
    return "#" + "".join(f"{round(LARGEST_PART * c):02x}" for c in channels) + colour[7:]


def night_rules(colours: Iterable[str]) -> str:
    """Return style rules that give marks of these fills and strokes their colour for a dark screen."""
    return "".join(
        f"[{name}='{colour}']{{{name}:{night_colour(colour)}}}"
        for colour in sorted(set(colours))
        for name in ("fill", "stroke")
    )


# Lines as SVG path data: points that a reader cannot see left out, steps in tenths of a px.

# distance from the line drawn [px] up to which a point is left out; places of a px after the point
UNSEEN, PLACES = 0.15, 10


def path_data(px: Array, py: Array) -> str:
    """Return the path through positions in px, shape (n,) each; NaN leaves a gap, a point alone is not drawn."""
    finite = np.isfinite(px) & np.isfinite(py)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], finite, [False]]).astype(int)))
    return "".join(_stretch(px[a:b], py[a:b]) for a, b in zip(ends[::2], ends[1::2], strict=True))


def _stretch(px: Array, py: Array) -> str:
    kept = visible_points(px, py)
    x, y = (np.round(PLACES * p[kept]).astype(int) for p in (px, py))
    steps = [(int(dx), int(dy)) for dx, dy in zip(np.diff(x), np.diff(y), strict=True) if dx or dy]
    moves = "".join(_tenths_text(dx, is_first=k == 0) + _tenths_text(dy) for k, (dx, dy) in enumerate(steps))
    return f"M{_tenths_text(int(x[0]), is_first=True)}{_tenths_text(int(y[0]))}" + (f"l{moves}" if moves else "")


def _tenths_text(tenths: int, *, is_first: bool = False) -> str:
    """Tenths of a px as short as SVG allows, with a blank before it where the minus does not part it."""
    units, rest = divmod(abs(tenths), PLACES)
    digits = (str(units) if units or not rest else "") + (f".{rest}" if rest else "")
    sign = "-" if tenths < 0 else ("" if is_first else " ")
    return sign + digits


def visible_points(px: Array, py: Array) -> NDArray[np.bool_]:
    """Return which points a line needs so that no point is farther from it than can be seen (Douglas & Peucker 1973).

    Cartographica 10, 112-122; the first and the last point are always among them.
    """
    kept = np.zeros(len(px), dtype=bool)
    kept[[0, -1]] = True
    stretches = [(0, len(px) - 1)]
    while stretches:
        a, b = stretches.pop()
        if b - a < 2:
            continue
        x, y = px[a + 1 : b] - px[a], py[a + 1 : b] - py[a]
        across, down = px[b] - px[a], py[b] - py[a]
        length = float(np.hypot(across, down))
        along = (x * across + y * down) / length**2 if length > 0.0 else np.zeros_like(x)
        share = np.minimum(np.maximum(along, 0.0), 1.0)
        distance = np.hypot(x - share * across, y - share * down)
        k = int(distance.argmax())
        if distance[k] > UNSEEN:
            kept[a + 1 + k] = True
            stretches += [(a, a + 1 + k), (a + 1 + k, b)]
    return kept


# Charts as SVG text that scales with the page; a report of three hundred panels takes a fraction of a second.

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
