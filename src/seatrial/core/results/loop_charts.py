"""How near loops are to instability: |S| and |T| over frequency, and the open loop near -1."""

import math

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    Anchor,
    Area,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Panel,
    Points,
    Region,
    Rule,
    Shape,
    Stroke,
    Text,
    tiles,
)
from seatrial.core.figures.panels import STROKES
from seatrial.core.results.tuning import Controller, Tuning

# loops drawn at most
MAX_LOOPS = 6
CHOSEN, LIMIT = Stroke(ACCENT, 2.2), Stroke(SECOND, 1.1, "5 3")  # px, chosen
# dashes distinguish the baselines without colour
BASELINE_STROKES = (Stroke(INK, 1.1, "6 2.5"), *STROKES[2:])
# range of the open loop about -1: real and imaginary part; height of its panel [px]
REAL, IMAGINARY, NYQUIST_HEIGHT = (-2.4, 1.4), (-1.9, 1.9), 380.0
# top of the axis in Ms allowed: the highest, and the least
CUT, LEAST_TOP = 2.5, 1.15
# dB, below which a size is cut off; dB a factor of ten, by definition
LEAST_SIZE_DB, DECIBELS = -80.0, 20.0
# dB, size below which a phase is not drawn; chosen: no change of gain that one would make brings it to 0 dB
PHASE_SIZE_DB = -40.0


def styled_controllers(tuning: Tuning) -> list[tuple[Controller, Stroke]]:
    """Return the chosen controller and the first baselines, as far as their loop is known, with their lines."""
    strokes = [CHOSEN, *(BASELINE_STROKES[k % len(BASELINE_STROKES)] for k in range(len(tuning.compared) - 1))]
    controllers = zip(tuning.compared, strokes, strict=True)
    return [(c, stroke) for c, stroke in controllers if len(c.omega) > 1][:MAX_LOOPS]


def sensitivity_chart(tuning: Tuning) -> Chart | None:
    """Return |S| with the largest Ms allowed and |T| side by side over frequency; None where no loop is known."""
    styled = styled_controllers(tuning)
    if not styled:
        return None
    allowed = tuning.constraints.Ms
    frequencies = np.concatenate([c.omega for c, _ in styled])
    x = Axis((float(frequencies.min()), float(frequencies.max())), "ω [rad/s]", is_logarithmic=True)
    sensitivities = [1.0 / np.abs(1.0 + c.open_loop) for c, _ in styled]
    complementary = [np.abs(c.open_loop / (1.0 + c.open_loop)) for c, _ in styled]
    # px, chosen
    limit = [Rule(allowed, LIMIT), Text(x.ends[0], allowed, f"Ms = {allowed:.3g} allowed", size=10.0, colour=SECOND,
                                        dx=5.0, dy=-4.0)]  # fmt: skip
    panels = []
    for box, title, sizes, extra in zip(
        tiles(2, 2, 220.0, left=58.0, right=12.0),  # px, chosen
        ("sensitivity |S|", "complementary sensitivity |T|"),
        (sensitivities, complementary),
        (limit if math.isfinite(allowed) else [], []),
        strict=True,
    ):
        lines = [Line(c.omega, size, stroke) for (c, stroke), size in zip(styled, sizes, strict=True)]
        panels.append(Panel(box, x, Axis((0.0, _axis_top(sizes, allowed))), (*reversed(lines), *extra), title))
    return Chart("sensitivities over frequency", tuple(panels), _legend(styled))


def bode_chart(tuning: Tuning) -> Chart | None:
    """Return size [dB] and phase [deg] of the open loop over frequency; None where no loop is known."""
    styled = styled_controllers(tuning)
    if not styled:
        return None
    frequencies = np.concatenate([c.omega for c, _ in styled])
    x = Axis((float(frequencies.min()), float(frequencies.max())), "ω [rad/s]", is_logarithmic=True)
    with np.errstate(divide="ignore"):
        sizes = [np.maximum(DECIBELS * np.log10(np.abs(c.open_loop)), LEAST_SIZE_DB) for c, _ in styled]
    phases = [np.degrees(np.unwrap(np.angle(c.open_loop))) for c, _ in styled]
    phases = [phase - 360.0 * np.round(np.median(phase) / 360.0) for phase in phases]
    phases = [np.where(size < min(PHASE_SIZE_DB, size.max()), math.nan, phase)
              for phase, size in zip(phases, sizes, strict=True)]  # fmt: skip
    panels = []
    for box, title, curves, mark in zip(
        tiles(2, 2, 220.0, left=58.0, right=12.0),  # px, chosen
        ("size of the open loop |L| [dB]", "phase of the open loop [°]"),
        (sizes, phases),
        (0.0, -180.0),
        strict=True,
    ):
        lines = [Line(c.omega, curve, stroke) for (c, stroke), curve in zip(styled, curves, strict=True)]
        low, high = min(float(np.nanmin(c)) for c in curves), max(float(np.nanmax(c)) for c in curves)
        pad = 0.05 * max(high - low, 1.0)  # above and below the curves, chosen
        y = Axis((min(low, mark) - pad, max(high, mark) + pad))
        panels.append(Panel(box, x, y, (*reversed(lines), Rule(mark, LIMIT)), title))
    return Chart("Bode diagram of the open loop", tuple(panels), _legend(styled))


def nyquist_chart(tuning: Tuning) -> Chart | None:
    """Return the open loop near -1 for positive frequencies, with the circle that the largest Ms keeps free."""
    styled = styled_controllers(tuning)
    if not styled:
        return None
    width = NYQUIST_HEIGHT * (REAL[1] - REAL[0]) / (IMAGINARY[1] - IMAGINARY[0])
    marks: list[Mark] = [_circle(0.0, 1.0, Stroke(GREY, 0.9))]  # px, chosen
    radius = 1.0 / tuning.constraints.Ms
    if 0.0 < radius < math.inf:
        marks += [
            _circle(-1.0, radius, LIMIT, "#f9efec"),
            Text(-1.0, radius, f"Ms = {tuning.constraints.Ms:.3g}", Anchor.MIDDLE, 10.0, SECOND, dy=-5.0),  # px, chosen
        ]
    marks += [Line(c.open_loop.real, c.open_loop.imag, stroke) for c, stroke in reversed(styled)]
    # px, chosen
    marks += [Points(np.array([-1.0]), np.zeros(1), Marker(Shape.PLUS, 4.0, INK, edge_width=1.6)),
              Text(-1.0, 0.0, "−1", size=10.0, dx=6.0, dy=-5.0)]  # fmt: skip
    # px, chosen; seven ticks
    panel = Panel(Region(58.0, 4.0, width, NYQUIST_HEIGHT), Axis(REAL, "Re L", tick_count=7),
                  Axis(IMAGINARY, "Im L", tick_count=7), tuple(marks))  # fmt: skip
    return Chart("open loop near -1", (panel,), _legend(styled), width=width + 98.0)


def _legend(styled: list[tuple[Controller, Stroke]]) -> tuple[LegendEntry, ...]:
    return tuple(LegendEntry(c.name, stroke) for c, stroke in styled)


def _axis_top(sizes: list[Array], allowed: float) -> float:
    """Top of the axis: everything of loops that keep near the limit; what is far beyond is cut off."""
    highest = max((float(np.max(s[np.isfinite(s)], initial=0.0)) for s in sizes), default=1.0)
    if not math.isfinite(allowed):
        return max(1.2, 1.08 * highest)  # 8 % more than the highest
    # 8 % more than the highest
    return max(LEAST_TOP * allowed, min(1.08 * highest, CUT * allowed))


def _circle(centre: float, radius: float, stroke: Stroke, fill: str = "none") -> Area:
    angle = np.linspace(0.0, 2.0 * math.pi, 121)  # points of a curve, chosen
    return Area(centre + radius * np.cos(angle), radius * np.sin(angle), fill, stroke)
