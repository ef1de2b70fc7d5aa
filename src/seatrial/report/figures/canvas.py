"""How every figure looks and how it becomes a short piece of SVG for a page."""

import io
import re
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING

import numpy as np

from seatrial.values import Array, display, quantity
from seatrial.values.notation import NOTATION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 7.6
ACCENT, MEASURED, INK, FAINT, SECOND = "#1b4f72", "#b4b4b4", "#222222", "#d9d9d9", "#b03a2e"
POINTS = 400
_GREEK = {"psi": "ψ", "delta": "δ", "phi": "φ", "theta": "θ"}
_PLAIN = {"x0": "x₀", "y0": "y₀", "v_j": "vⱼ", "u_dot": "u̇", "v_dot": "v̇"}
_FONTS = "Arial, Helvetica, 'Liberation Sans', 'DejaVu Sans', sans-serif"
_STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "seatrial",
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "axes.titlesize": 7.5,
    "axes.labelsize": 7.5,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#666666",
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "grid.color": "#ececec",
    "grid.linewidth": 0.6,
    "xtick.color": "#666666",
    "ytick.color": "#666666",
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "lines.solid_capstyle": "round",
}


def canvas(height: float, width: float = WIDTH) -> "Figure":
    """An empty figure of the report's width, inches."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        return Figure(figsize=(width, height), layout="constrained")


def svg(figure: "Figure", title: str, prefix: str) -> str:
    """The figure as an SVG element that scales with the page; `prefix` keeps its identifiers apart from others'."""
    import html

    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    buffer = io.StringIO()
    with rc_context(_STYLE):
        FigureCanvasSVG(figure).print_svg(buffer, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"(\d\.\d\d)\d+", r"\1", text)
    text = re.sub(r'(id="|url\(#|href="#)', rf"\g<1>{prefix}-", text)
    text = re.sub(r"font(-family)?: ([^;\"]*)'DejaVu Sans'[^;\"]*", rf"font\g<1>: \g<2>{_FONTS}", text)
    text = re.sub(r"\s*\n\s*", " ", text)
    height = re.search(r'viewBox="0 0 (\S+) (\S+)"', text)
    box = f'viewBox="0 0 {height[1]} {height[2]}"' if height else ""
    return re.sub(r"<svg[^>]*>", f'<svg xmlns="http://www.w3.org/2000/svg" '
                  f'xmlns:xlink="http://www.w3.org/1999/xlink" {box} role="img" aria-label="{html.escape(title)}">',
                  text, count=1)  # fmt: skip


def styled() -> "AbstractContextManager[None]":
    """The style as a context: axes must be made within it."""
    from matplotlib import rc_context

    return rc_context(_STYLE)


def decimated(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """A curve of at most about `points` points that keeps the extremes of every stretch; gaps (NaN) stay gaps."""
    if len(x) <= points:
        return x, y
    edges = np.linspace(0, len(x), points // 2 + 1).astype(int)
    low, high = np.where(np.isnan(y), np.inf, y), np.where(np.isnan(y), -np.inf, y)
    kept = []
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        kept += sorted({first + int(np.argmin(low[first:last])), first + int(np.argmax(high[first:last]))})
    return x[kept], y[kept]


def thinned(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """Every k-th point of a track and its last."""
    if len(x) <= points:
        return x, y
    kept = np.unique(np.linspace(0, len(x) - 1, points).astype(int))
    return x[kept], y[kept]


def symbol(name: str) -> str:
    """A channel's name in letters: ``psi`` -> ψ."""
    return _GREEK.get(name) or _PLAIN.get(name) or name


def label(name: str, unit: str = "") -> str:
    """Axis label with the unit people read."""
    known = unit or (quantity(name).unit if name in NOTATION else "1")
    shown = display(known)[1]
    return symbol(name) if shown == "1" else f"{symbol(name)} [{shown}]"


def shown(name: str, values: Array, unit: str) -> Array:
    """Values in the unit people read; headings without wrap."""
    unwrapped = _unwrapped(values) if name == "psi" else values
    return unwrapped * display(unit)[0]


def _unwrapped(angle: Array) -> Array:
    known = np.isfinite(angle)
    if not known.any():
        return angle
    made = np.full_like(angle, np.nan)
    made[known] = np.unwrap(angle[known])
    return made - 2.0 * np.pi * np.round(made[known][0] / (2.0 * np.pi))


def bare(axes: "Axes") -> None:
    """No frame, no ticks."""
    axes.set_axis_off()
