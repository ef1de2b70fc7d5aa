"""Rows of dots and bars over a logarithmic axis: how well each direction is told, and what each coefficient does."""

import math
from collections.abc import Sequence

from seatrial.core.figures.plot import (
    ACCENT,
    AXIS,
    FAINT,
    GREY,
    INK,
    SECOND,
    WIDTH,
    Panel,
    Stroke,
    drawing,
    rectangle,
    segment,
    text,
)
from seatrial.core.results import Direction, Sensitivity
from seatrial.core.text.numbers import MINUS, exact

ROW, TOP = 18.0, 24.0
WELL_DETERMINED, UNDETERMINED = 10.0, 100.0
TERMS, LARGE = 3, 0.3
_VAGUE_COLOUR = "#8a5a00"
_LETTER = 6.1
_ZONES = ("#eaf1f6", "#fbf4e4", "#f8e9e6")


def directions(items: Sequence[Direction]) -> str:
    """A dot for each direction at its standard deviation in per cent, weakest first; empty for none.

    Those without any information (infinite) stand at the right edge with an arrow.
    """
    if not items:
        return ""
    spreads = [100.0 * d.standard_deviation for d in items]
    names = [combination_text(d) for d in items]
    panel = decade_panel(names, [s for s in spreads if math.isfinite(s) and s > 0], (1.0, 1000.0))
    ends = (panel.x[0], math.log10(WELL_DETERMINED), math.log10(UNDETERMINED), panel.x[1])
    parts = []
    for k, (zone, label) in enumerate(zip(_ZONES, ("told well", "told vaguely", "not told"), strict=True)):
        left, right = float(panel.px(ends[k])), float(panel.px(ends[k + 1]))
        parts.append(rectangle(left, panel.top, right - left, panel.height, zone))
        parts.append(text((left + right) / 2, panel.top - 7, label, anchor="middle", colour=_colour(k), size=10.5))
    parts.append(decade_axis(panel, " %", "standard deviation along the combination, per cent of the coefficients"))
    parts += [_limit_line(panel, limit) for limit in (WELL_DETERMINED, UNDETERMINED)]
    for k, (name, spread) in enumerate(zip(names, spreads, strict=True)):
        y = float(panel.py(k))
        parts.append(text(panel.left_edge - 8, y + 4, name, anchor="end", size=10.5))
        parts.append(_dot(panel, spread, y))
    return drawing(parts, panel.top + panel.height + 38, "how well combinations of coefficients are told")


def sensitivities(items: Sequence[Sensitivity]) -> str:
    """A bar for each coefficient: effect of 10 % in units of noise; empty for none."""
    known = [s for s in items if math.isfinite(s.effect) and s.effect > 0]
    if not known:
        return ""
    panel = decade_panel([s.parameter for s in known], [s.effect for s in known], (0.1, 10.0))
    parts = [
        decade_axis(panel, "", "change of the compared outputs for 10 % of the coefficient, in units of their noise")
    ]
    for k, s in enumerate(known):
        y = float(panel.py(k))
        parts.append(text(panel.left_edge - 8, y + 4, s.parameter, anchor="end", size=10.5))
        length = float(panel.px(math.log10(s.effect))) - panel.left_edge
        parts.append(rectangle(panel.left_edge, y - 5, length, 10, ACCENT if s.effect >= 1 else "#a9bccb"))
    parts.append(_limit_line(panel, 1.0))
    parts.append(text(float(panel.px(0)), panel.top - 7, "as large as the noise", anchor="middle", size=10.5))
    return drawing(parts, panel.top + panel.height + 38, "what each coefficient does to the records")


def combination_text(d: Direction) -> str:
    """The largest parts of a direction: ``.74 Y_v − .56 N_v …``."""
    largest = max((abs(part) for part in d.combination.values()), default=0.0)
    large = [(name, part) for name, part in d.combination.items() if abs(part) >= LARGE * largest]
    told = [f"{MINUS if part < 0 else '+'} {_part(part)}{name}" for name, part in large[:TERMS]]
    joined = " ".join(told).removeprefix("+ ")
    return joined + (" …" if len(large) > TERMS else "")


def _part(part: float) -> str:
    rounded = f"{abs(part):.2f}"
    return "" if rounded == "1.00" else rounded.removeprefix("0") + " "


def decade_panel(
    names: Sequence[str], values: Sequence[float], least_range: tuple[float, float], top: float = TOP
) -> Panel:
    """Whole decades about the values, at least those of `least`; room for the names at the left."""
    low = math.floor(math.log10(min([*values, least_range[0]])))
    high = math.ceil(math.log10(max([*values, least_range[1]])))
    margin = min(0.45 * WIDTH, _LETTER * max(len(name) for name in names) + 14)
    return Panel(
        margin, top, WIDTH - margin - 24, ROW * len(names), (low, high), (-0.5, len(names) - 0.5), is_y_down=True
    )


def decade_axis(panel: Panel, unit: str, name: str) -> str:
    """Decades as grid lines with their numbers, the name below."""
    bottom = panel.top + panel.height
    parts = []
    for decade in range(int(panel.x[0]), int(panel.x[1]) + 1):
        x = float(panel.px(decade))
        parts.append(segment(x, panel.top, x, bottom, Stroke(FAINT, 0.8)))
        parts.append(text(x, bottom + 13, exact(10.0**decade) + unit, anchor="middle", size=10))
    parts.append(segment(panel.left_edge, bottom, panel.left_edge + panel.width, bottom, Stroke(AXIS, 0.8)))
    parts.append(text(panel.left_edge + panel.width / 2, bottom + 30, name, anchor="middle"))
    return "".join(parts)


def _limit_line(panel: Panel, limit: float) -> str:
    x = float(panel.px(math.log10(limit)))
    return segment(x, panel.top, x, panel.top + panel.height, Stroke(INK, 0.9, "3 2"))


def _dot(panel: Panel, spread: float, y: float) -> str:
    """Filled where told well, open where vaguely, a square where not: told apart without colour."""
    zone = (spread >= WELL_DETERMINED) + (spread >= UNDETERMINED)
    if not math.isfinite(spread):
        right = panel.left_edge + panel.width
        return text(right - 6, y + 4, "no information ▸", anchor="end", size=10.5, colour=_colour(zone))
    x = float(panel.px(math.log10(max(spread, 10.0 ** panel.x[0]))))
    line = segment(panel.left_edge, y, x, y, Stroke(GREY, 0.7))
    if zone == 2:
        return line + rectangle(x - 3.6, y - 3.6, 7.2, 7.2, _colour(zone))
    fill = _colour(zone) if zone == 0 else "#fff"
    return (
        line + f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.8" fill="{fill}" stroke="{_colour(zone)}" stroke-width="1.6"/>'
    )


def _colour(zone: int) -> str:
    return (ACCENT, _VAGUE_COLOUR, SECOND)[zone]
