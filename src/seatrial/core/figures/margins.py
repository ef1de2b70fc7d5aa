"""How near loops are to instability: |S| and |T| over frequency, and the open loop near -1."""

import math

import numpy as np

from seatrial.core.figures.curves import STROKES
from seatrial.core.figures.plot import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    WIDTH,
    Panel,
    Stroke,
    axes,
    clipped,
    drawing,
    path,
    segment,
    text,
)  # fmt: skip
from seatrial.core.figures.scales import Scale, grid, legend
from seatrial.core.results.tuning import Controller, Tuning
from seatrial.core.values import Array

LEFT, HEIGHT, MOST = 58.0, 220.0, 6
CHOSEN, LIMIT = Stroke(ACCENT, 2.2), Stroke(SECOND, 1.1, "5 3")
# rivals: dashes tell them apart without colour
BASELINE_STROKES = (Stroke(INK, 1.1, "6 2.5"), *STROKES[2:])
SIDE, REAL, IMAGINARY = 380.0, (-2.4, 1.4), (-1.9, 1.9)


def styled_controllers(tuning: Tuning) -> list[tuple[Controller, Stroke]]:
    """The chosen controller and the first rivals, those whose loop is known."""
    some = [
        (tuning.chosen, CHOSEN),
        *((c, BASELINE_STROKES[k % len(BASELINE_STROKES)]) for k, c in enumerate(tuning.baselines)),
    ]
    return [(c, stroke) for c, stroke in some if len(c.omega) > 1][:MOST]


def sensitivities(tuning: Tuning) -> str:
    """|S| with the largest Ms allowed, and |T|, side by side; empty where no loop is known."""
    drawn = styled_controllers(tuning)
    if not drawn:
        return ""
    low, high = (f([f(np.log10(c.omega)) for c, _ in drawn]) for f in (np.min, np.max))
    x = Scale((float(low), float(high)), is_logarithmic=True)
    allowed = tuning.constraints.Ms
    head, top = legend([(c.name, stroke) for c, stroke in drawn])
    width = (WIDTH - 2 * LEFT - 30) / 2
    parts = [head]
    loops = [(c.omega, 1.0 + c.open_loop) for c, _ in drawn]
    for k, (title, sizes) in enumerate((
        ("sensitivity |S|", [1.0 / np.abs(d) for _, d in loops]),
        ("complementary sensitivity |T|", [np.abs((d - 1.0) / d) for _, d in loops]),
    )):  # fmt: skip
        y = Scale((0.0, _axis_top(sizes, allowed)), is_logarithmic=False)
        panel = Panel(LEFT + (width + LEFT + 16) * k, top + 20, width, HEIGHT, x.ends, y.ends)
        parts.append(grid(panel, x, y, x_label="ω [rad/s]", title=title))
        rows = zip(loops, sizes, drawn, strict=True)
        lines = [panel.curve(np.log10(w), size, stroke) for (w, _), size, (_, stroke) in rows]
        parts.append(clipped(panel, "".join(reversed(lines))))
        if k == 0 and math.isfinite(allowed):
            parts.append(_limit_line(panel, allowed))
    return drawing(parts, top + 20 + HEIGHT + 36, "sensitivities over frequency")


def nyquist(tuning: Tuning) -> str:
    """The open loop near -1 for positive frequencies, with the circle that the largest Ms keeps free."""
    drawn = styled_controllers(tuning)
    if not drawn:
        return ""
    width = SIDE * (REAL[1] - REAL[0]) / (IMAGINARY[1] - IMAGINARY[0])
    head, top = legend([(c.name, stroke) for c, stroke in drawn], right=LEFT + width + 40)
    panel = Panel(LEFT, top + 8, width, SIDE, REAL, IMAGINARY)
    radius = 1.0 / tuning.constraints.Ms
    parts = [head, axes(panel, x_ticks=7, y_ticks=7, x_label="Re L", y_label="Im L")]
    inside = [_circle(panel, 0.0, 1.0, Stroke(GREY, 0.9))]
    if 0.0 < radius < math.inf:
        inside.append(_circle(panel, -1.0, radius, LIMIT, "#f9efec"))
    inside += [panel.curve(c.open_loop.real, c.open_loop.imag, stroke) for c, stroke in reversed(drawn)]
    parts.append(clipped(panel, "".join(inside)))
    x, y = float(panel.px(-1.0)), float(panel.py(0.0))
    parts += [segment(x - 4, y, x + 4, y, Stroke(INK, 1.6)), segment(x, y - 4, x, y + 4, Stroke(INK, 1.6))]
    parts.append(text(x + 6, y - 5, "−1", size=10))
    if 0.0 < radius < math.inf:
        above = float(panel.py(radius)) - 5
        words = f"Ms = {tuning.constraints.Ms:.3g}"
        parts.append(text(x, above, words, anchor="middle", size=10, colour=SECOND))
    return drawing(parts, panel.top + SIDE + 40, "open loop near -1", LEFT + width + 40)


def _axis_top(sizes: list[Array], max_Ms: float) -> float:
    """Top of the axis: everything of stable loops that keep near the limit; what is far beyond is cut off."""
    highest = max((float(np.max(s[np.isfinite(s)], initial=0.0)) for s in sizes), default=1.0)
    roof = 2.5 * max_Ms if math.isfinite(max_Ms) else math.inf
    least = 1.15 * max_Ms if math.isfinite(max_Ms) else 1.2
    return max(least, min(1.08 * highest, roof))


def _limit_line(panel: Panel, max_Ms: float) -> str:
    y = float(panel.py(max_Ms))
    words = text(panel.left_edge + 5, y - 4, f"Ms = {max_Ms:.3g} allowed", size=10, colour=SECOND)
    return segment(panel.left_edge, y, panel.left_edge + panel.width, y, LIMIT) + words


def _circle(panel: Panel, centre: float, radius: float, stroke: Stroke, fill: str = "none") -> str:
    angle = np.linspace(0.0, 2.0 * math.pi, 121)
    return path(panel.px(centre + radius * np.cos(angle)), panel.py(radius * np.sin(angle)), stroke, fill)
