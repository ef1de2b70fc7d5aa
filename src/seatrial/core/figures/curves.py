"""Named curves over one pair of axes; line styles distinguish them without colour."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.figures.chart import WIDTH, Axis, Chart, LegendEntry, Panel, Region
from seatrial.core.figures.marks import ACCENT, INK, SECOND, Array, Line, Stroke
from seatrial.core.figures.ticks import decimated, span, thinned

# px, chosen
STROKES = (
    Stroke(INK, 1.3), Stroke(ACCENT, 1.5, "6 3"), Stroke(SECOND, 1.5, "7 2 1.5 2"), Stroke("#6c7a89", 1.7, "1.5 2.5"),
    Stroke("#2e7d5b", 1.4, "9 2 1.5 2 1.5 2"), Stroke("#8e6c1f", 1.4, "3 1.5"), Stroke("#5b4a7a", 1.4, "1 4"),
)  # fmt: skip
# height of the panel [px], and of a map over that
HEIGHT, MAP_RATIO = 300.0, 1.4
LEFT = 64.0  # px, chosen


@dataclass(frozen=True, eq=False)
class NamedCurve:
    """A curve of arrays of equal length with its name in the legend."""

    name: str
    x: Array
    y: Array


def curves_chart(title: str, curves: Sequence[NamedCurve], x_name: str, y_name: str, *, is_map: bool = False) -> Chart:
    """Return curves with their legend; the axes of a map have equal scales."""
    x, y = span([c.x for c in curves]), span([c.y for c in curves])
    box = Region(LEFT, 8.0, WIDTH - LEFT - 8.0, HEIGHT)  # px, chosen
    if is_map:
        scale = max((x[1] - x[0]) / box.width, (y[1] - y[0]) / (MAP_RATIO * HEIGHT))
        box = Region(LEFT, 8.0, (x[1] - x[0]) / scale, (y[1] - y[0]) / scale)  # px, chosen
    sampled = thinned if is_map else decimated
    styled = [(c, STROKES[k % len(STROKES)]) for k, c in enumerate(curves)]
    lines = tuple(Line(*sampled(c.x, c.y), stroke) for c, stroke in styled)
    panel = Panel(box, Axis(x, x_name, tick_count=7), Axis(y, y_name, tick_count=6), lines)  # ticks, chosen
    return Chart(title, (panel,), tuple(LegendEntry(c.name, stroke) for c, stroke in styled))
