"""A small plotter for pages: panels with axes, curves and labels as SVG text, measured in pixels of a page.

A report has some three hundred panels; drawn here they take a fraction of a second and a few hundred kilobytes.
"""

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, display_unit
from seatrial.core.values.notation import NOTATION

WIDTH = 864.0
ACCENT, GREY, INK, FAINT, AXIS, SECOND = "#1b4f72", "#b2b2b2", "#222222", "#ececec", "#8a9299", "#a33022"
POINTS = 400
FONT = "Arial, Helvetica, 'Liberation Sans', 'DejaVu Sans', sans-serif"
_SYMBOLS = {
    "psi": "ψ", "delta": "δ", "phi": "φ", "theta": "θ", "alpha_f": "α", "x0": "x₀", "y0": "y₀", "v_j": "vⱼ",
    "wind_speed": "wind", "wind_direction": "wind from", "wind_speed_relative": "app. wind",
    "wind_direction_relative": "app. wind from",
}  # fmt: skip


@dataclass(frozen=True)
class Stroke:
    """How a curve is drawn; `dash` as in SVG."""

    colour: str
    width: float
    dash: str = ""


MEASURED = Stroke(GREY, 3.0)
SIMULATED = Stroke(ACCENT, 1.4, "5 2.5")
PLAIN = Stroke(INK, 0.9)


@dataclass(frozen=True)
class Panel:
    """A rectangle of the page (left, top, width, height in px) and the ranges it shows; `down`: y grows downwards."""

    left_edge: float
    top: float
    width: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]
    is_y_down: bool = False

    def px(self, x: Array | float) -> Array:
        """Horizontal places in px."""
        return self.left_edge + (np.asarray(x, float) - self.x[0]) / (self.x[1] - self.x[0]) * self.width

    def py(self, y: Array | float) -> Array:
        """Vertical places in px, counted downwards."""
        share = (np.asarray(y, float) - self.y[0]) / (self.y[1] - self.y[0])
        return self.top + (share if self.is_y_down else 1.0 - share) * self.height

    def curve(self, x: Array, y: Array, stroke: Stroke) -> str:
        """A line through the points; NaN leaves a gap."""
        return path(self.px(x), self.py(y), stroke)


def path(px: Array, py: Array, stroke: Stroke, fill: str = "none") -> str:
    """A line through places in px; NaN leaves a gap."""
    known = np.isfinite(px) & np.isfinite(py)
    starts = known & ~np.concatenate([[False], known[:-1]])
    words = [f"{'M' if s else 'L'}{x:.1f} {y:.1f}" for x, y, k, s in zip(px, py, known, starts, strict=True) if k]
    dash = f' stroke-dasharray="{stroke.dash}"' if stroke.dash else ""
    return (
        f'<path d="{"".join(words)}" fill="{fill}" stroke="{stroke.colour}" stroke-width="{stroke.width:g}"'
        f'{dash} stroke-linejoin="round"/>'
    )


def segment(x1: float, y1: float, x2: float, y2: float, stroke: Stroke) -> str:
    """A straight line between places in px."""
    return path(np.array([x1, x2]), np.array([y1, y2]), stroke)


def clipped(panel: Panel, parts: str) -> str:
    """Parts drawn inside a panel only."""
    box = f"{panel.left_edge:.1f} {panel.top:.1f} {panel.width:.1f} {panel.height:.1f}"
    x, y, width, height = box.split()
    return f'<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{box}">{parts}</svg>' if parts else ""


def rectangle(left_edge: float, top: float, width: float, height: float, fill: str) -> str:
    """A filled rectangle in px."""
    return f'<rect x="{left_edge:.1f}" y="{top:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{fill}"/>'


def text(x: float, y: float, words: str, *, anchor: str = "start", size: float = 11, colour: str = INK,
         turn: float = 0.0) -> str:  # fmt: skip
    """Words at a place in px; `turn` in degrees clockwise."""
    turned = f' transform="rotate({turn:g} {x:.1f} {y:.1f})"' if turn else ""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size:g}" fill="{colour}"{turned}>'
        f"{html.escape(words)}</text>"
    )


def drawing(parts: Sequence[str], height: float, title: str, width: float = WIDTH) -> str:
    """The parts as one SVG element that scales with the page."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
        f'style="max-width:{width:.0f}px" role="img" '
        f'aria-label="{html.escape(title)}" font-family="{FONT}">{"".join(parts)}</svg>'
    )


def axes(panel: Panel, *, x_ticks: int = 5, y_ticks: int = 4, x_labels: bool = True, y_labels: bool = True,
         x_label: str = "", y_label: str = "", title: str = "", size: float = 10) -> str:  # fmt: skip
    """Grid, axis lines, tick labels and names of a panel."""
    bottom, right = panel.top + panel.height, panel.left_edge + panel.width
    grid, line = Stroke(FAINT, 0.8), Stroke(AXIS, 0.8)
    parts = []
    for value in ticks(*panel.x, x_ticks):
        at = float(panel.px(value))
        parts.append(segment(at, panel.top, at, bottom, grid))
        if x_labels:
            parts.append(text(at, bottom + size + 3, tick_text(value, panel.x), anchor="middle", size=size))
    for value in ticks(*panel.y, y_ticks):
        at = float(panel.py(value))
        parts.append(segment(panel.left_edge, at, right, at, grid))
        if y_labels:
            words = tick_text(value, panel.y)
            parts.append(text(panel.left_edge - 4, at + 0.36 * size, words, anchor="end", size=size))
    parts += [
        segment(panel.left_edge, panel.top, panel.left_edge, bottom, line),
        segment(panel.left_edge, bottom, right, bottom, line),
    ]
    if x_label:
        parts.append(text(panel.left_edge + panel.width / 2, bottom + 2 * size + 8, x_label, anchor="middle"))
    if y_label:
        middle = panel.top + panel.height / 2
        parts.append(text(panel.left_edge - 38, middle, y_label, anchor="middle", turn=-90))
    if title:
        parts.append(text(panel.left_edge, panel.top - 6, title))
    return "".join(parts)


def legend(entries: Sequence[tuple[str, Stroke]], right: float, y: float) -> str:
    """Names with a sample of their line, ending at `right`."""
    parts, at = [], right
    for words, stroke in reversed(entries):
        at -= 6.2 * len(words)
        parts.append(text(at, y, words))
        parts.append(segment(at - 36, y - 4, at - 6, y - 4, stroke))
        at -= 54
    return "".join(parts)


def ticks(low: float, high: float, count: int) -> list[float]:
    """Round numbers within a range, about so many: steps of 1, 2 or 5 times a power of ten."""
    if not high > low:
        return [low]
    power = 10.0 ** math.floor(math.log10((high - low) / max(1, count)))
    choices = [_multiples(low, high, m * power) for m in (0.5, 1.0, 2.0, 5.0, 10.0)]
    return min(choices, key=lambda values: (len(values) < 2, abs(len(values) - count)))


def _multiples(low: float, high: float, step: float) -> list[float]:
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step + 0.0 for k in range(first, last + 1)]


def tick_text(value: float, axis_range: tuple[float, float]) -> str:
    """A tick's number, a true minus sign, powers of ten far from one."""
    reach = max(abs(axis_range[0]), abs(axis_range[1]))
    if abs(value) < 1e-9 * reach:
        return "0"
    words = f"{value:.6g}" if 1e-3 <= reach < 1e6 else f"{value:.3g}"
    return words.replace("-", "−")


def span(arrays: Sequence[Array], margin: float = 0.06) -> tuple[float, float]:
    """A range about all finite values, a little wider; about a constant, wide enough to see it is one."""
    known = np.concatenate([a[np.isfinite(a)] for a in arrays]) if arrays else np.empty(0)
    if known.size == 0:
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    room = margin * (high - low) if high - low > 1e-9 * max(abs(low), abs(high)) else 0.05 * abs(low) or 1.0
    return low - room, high + room


def decimated(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """A curve of at most about `points` points that keeps the extremes of every stretch; gaps (NaN) stay gaps."""
    if len(x) <= points:
        return x, y
    edges = np.linspace(0, len(x), points // 2 + 1).astype(int)
    low, high = np.where(np.isnan(y), np.inf, y), np.where(np.isnan(y), -np.inf, y)
    kept: list[int] = []
    for first, last in pairwise(edges):
        kept += sorted({first + int(np.argmin(low[first:last])), first + int(np.argmax(high[first:last]))})
    return x[kept], y[kept]


def thinned(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """Evenly chosen points of a track, its ends among them."""
    kept = np.unique(np.linspace(0, len(x) - 1, min(points, len(x))).astype(int))
    return x[kept], y[kept]


def label(name: str, unit: str) -> str:
    """A channel's letter with the unit people read."""
    shown_unit = display_unit(unit)[1]
    letter = _SYMBOLS.get(name, name)
    return letter if shown_unit == "1" else f"{letter} [{shown_unit}]"


def channel_si_unit(channel: str) -> str:
    """SI unit of a channel of the notation table, ``1`` for others."""
    return NOTATION[channel].unit if channel in NOTATION else "1"


def display_values(name: str, values: Array, unit: str) -> Array:
    """Values in the unit people read; headings without wrap, beginning within a half turn of north."""
    return (_unwrapped(values) if name == "psi" else values) * display_unit(unit)[0]


def _unwrapped(angle: Array) -> Array:
    known = np.isfinite(angle)
    if not known.any():
        return angle
    made = np.full_like(angle, np.nan)
    made[known] = np.unwrap(angle[known])
    return made - 2.0 * np.pi * np.round(made[known][0] / (2.0 * np.pi))


def common_prefix(names: Sequence[str]) -> str:
    """The beginning that all names share, up to a separator; empty where it is short."""
    if len(names) < 2:
        return ""
    low, high = min(names), max(names)
    same = next((i for i, (a, b) in enumerate(zip(low, high, strict=False)) if a != b), min(len(low), len(high)))
    cut = max(low[:same].rfind(c) for c in "_- /") + 1
    return low[:cut] if cut >= 5 else ""
