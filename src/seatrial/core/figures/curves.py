"""A study's own curves over one pair of axes; line styles tell them apart without colour."""

from seatrial.core.figures.plot import (
    ACCENT,
    INK,
    SECOND,
    WIDTH,
    Panel,
    Stroke,
    axes,
    decimated,
    drawing,
    segment,
    span,
    text,
    thinned,
)  # fmt: skip
from seatrial.core.results.study import Figure

STROKES = (
    Stroke(INK, 1.3), Stroke(ACCENT, 1.5, "6 3"), Stroke(SECOND, 1.5, "7 2 1.5 2"), Stroke("#6c7a89", 1.7, "1.5 2.5"),
    Stroke("#2e7d5b", 1.4, "9 2 1.5 2 1.5 2"), Stroke("#8e6c1f", 1.4, "3 1.5"), Stroke("#5b4a7a", 1.4, "1 4"),
)  # fmt: skip
HEIGHT = 300.0


def curves(figure: Figure) -> str:
    """One figure of a study with its legend at the side."""
    x, y = span([c.x for c in figure.curves]), span([c.y for c in figure.curves])
    width = WIDTH - 280
    panel = Panel(64, 12, width, HEIGHT, x, y)
    if figure.is_map:
        scale = max((x[1] - x[0]) / width, (y[1] - y[0]) / (1.4 * HEIGHT))
        panel = Panel(64, 12, (x[1] - x[0]) / scale, (y[1] - y[0]) / scale, x, y)
    parts = [axes(panel, x_ticks=7, y_ticks=6, x_label=figure.x_label, y_label=figure.y_label)]
    for k, one in enumerate(figure.curves):
        stroke = STROKES[k % len(STROKES)]
        parts.append(panel.curve(*(thinned if figure.is_map else decimated)(one.x, one.y), stroke))
        at = 22 + 18 * k
        parts.append(segment(WIDTH - 200, at, WIDTH - 166, at, stroke))
        parts.append(text(WIDTH - 158, at + 4, one.name))
    return drawing(parts, max(panel.height + 54, 30 + 18 * len(figure.curves)), figure.title)
