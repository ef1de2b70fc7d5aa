"""How well each direction is determined, and profile likelihoods."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    Anchor,
    Axis,
    Chart,
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
    tiles,
)
from seatrial.core.figures.panels import SMALL, decades_axis, no_information, row_panel
from seatrial.core.results import Direction, Profile
from seatrial.core.text.numbers import MINUS, fixed
from seatrial.core.values import display_unit
from seatrial.core.values.notation import unit_text

# standard deviation [%] from which on a direction is poorly determined, and from which on it is not
POORLY_DETERMINED, UNDETERMINED = 10.0, 100.0
# parts of a direction that are named at most, and the least of them as a share of the largest
MAX_PARTS, LARGE = 3, 0.3
_ZONE_NAMES = ("well determined", "poorly determined", "not determined")
_ZONE_FILLS = ("#eaf1f6", "#fbf4e4", "#f8e9e6")
_ZONE_COLOURS = (ACCENT, "#8a5a00", SECOND)
# filled, open, square: distinguished without colour
_ZONE_MARKERS = (
    Marker(Shape.CIRCLE, 3.8, _ZONE_COLOURS[0], _ZONE_COLOURS[0], 1.6),
    Marker(Shape.CIRCLE, 3.8, _ZONE_COLOURS[1], "#ffffff", 1.6),
    Marker(Shape.SQUARE, 3.6, _ZONE_COLOURS[2], _ZONE_COLOURS[2], 0.0),
)
_LIMIT, _STEM = Stroke(INK, 0.9, "3 2"), Stroke(GREY, 0.7)  # px, chosen


def direction_chart(directions: Sequence[Direction]) -> Chart | None:
    """Return a dot for each direction at its standard deviation in per cent, in the order given; None for none.

    A direction without any information (infinite) has a note at the right edge.
    """
    if not directions:
        return None
    spreads = [100.0 * d.standard_deviation for d in directions]
    axis = decades_axis([s for s in spreads if math.isfinite(s) and s > 0.0], (1.0, 1000.0),
                        "standard deviation along the combination, per cent of the coefficients", " %")  # fmt: skip
    marks: list[Mark] = []
    bounds = (axis.ends[0], POORLY_DETERMINED, UNDETERMINED, axis.ends[1])
    for k, (name, fill) in enumerate(zip(_ZONE_NAMES, _ZONE_FILLS, strict=True)):
        marks.append(Rectangle(bounds[k], -0.5, bounds[k + 1], len(directions) - 0.5, fill))
        # px, chosen
        marks.append(
            Text(math.sqrt(bounds[k] * bounds[k + 1]), -0.5, name, Anchor.MIDDLE, SMALL, _ZONE_COLOURS[k], dy=-7.0)
        )
    marks += [Rule(limit, _LIMIT, is_vertical=True) for limit in (POORLY_DETERMINED, UNDETERMINED)]
    for row, spread in enumerate(spreads):
        zone = int(spread >= POORLY_DETERMINED) + int(spread >= UNDETERMINED)
        if math.isfinite(spread):
            x, y = np.array([axis.ends[0], max(spread, axis.ends[0])]), np.full(2, float(row))
            marks += [Line(x, y, _STEM), Points(x[1:], y[1:], _ZONE_MARKERS[zone])]
        else:
            marks.append(no_information(axis, row, _ZONE_COLOURS[zone]))
    panel = row_panel([combination_text(d) for d in directions], axis, marks)
    return Chart("how well combinations of coefficients are determined", (panel,))


def combination_text(direction: Direction) -> str:
    """Return the largest parts of a direction: ``0.74 Y_v − 0.56 N_v …``."""
    largest = max((abs(part) for part in direction.combination.values()), default=0.0)
    large = [(name, part) for name, part in direction.combination.items() if abs(part) >= LARGE * largest]
    parts = [f"{MINUS if part < 0 else '+'} {_factor(part)}{name}" for name, part in large[:MAX_PARTS]]
    return " ".join(parts).removeprefix("+ ") + (" …" if len(large) > MAX_PARTS else "")


def _factor(part: float) -> str:
    factor = fixed(abs(part), 2)
    return "" if factor == "1.00" else f"{factor} "


COLUMNS, HEIGHT = 3, 120.0  # px, chosen
# 95 % quantile of chi-squared with one degree of freedom, and the highest loss drawn
BOUND, HIGHEST = 3.84, 12.0


def profile_chart(profiles: Sequence[Profile], units: Mapping[str, str]) -> Chart | None:
    """Return a panel for each coefficient with its bound of 95 %; None for none.

    Args:
        units: parameter -> SI unit.
    """
    usable = [p for p in profiles if len(p.values) > 1 and min(p.values) < max(p.values)]
    if not usable:
        return None
    boxes = tiles(len(usable), COLUMNS, HEIGHT, left=54.0, right=10.0, gap=46.0)  # px, chosen
    panels = tuple(_panel(p, units.get(p.parameter, "1"), box) for p, box in zip(usable, boxes, strict=True))
    return Chart("profile likelihoods", panels)


def _panel(profile: Profile, unit: str, box: Region) -> Panel:
    factor, unit_shown = display_unit(unit)[0], unit_text(unit)
    values, costs = np.array(profile.values) * factor, np.array(profile.costs)
    order = np.argsort(values)
    highest = float(np.clip(1.05 * np.nanmax(costs), 1.3 * BOUND, HIGHEST))  # the bound is always visible
    x = Axis((float(values.min()), float(values.max())), tick_count=3)
    marks = [
        Rule(BOUND, Stroke(SECOND, 1.0, "4 2.5")),
        Text(x.ends[1], BOUND, "95 %", Anchor.END, 9.5, SECOND, dx=-2.0, dy=-4.0),  # px, chosen
        Line(values[order], np.where(costs <= highest, costs, np.nan)[order], Stroke(ACCENT, 1.6)),  # px, chosen
        *(Line(np.full(2, end * factor), np.array([0.0, BOUND]), Stroke(SECOND, 0.8))  # px, chosen
          for end in (profile.lower, profile.upper) if end is not None),
    ]  # fmt: skip
    name = f"{profile.parameter} [{unit_shown}]" if unit_shown else profile.parameter
    return Panel(box, x, Axis((0.0, highest), "χ² lost", tick_count=3), tuple(marks), name)
