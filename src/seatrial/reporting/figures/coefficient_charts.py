"""Charts of coefficients: directions that records leave open, densities, and relative errors."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    Anchor,
    Axis,
    Chart,
    LegendEntry,
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
from seatrial.core.results import CredibleInterval, Direction, Posterior, Profile
from seatrial.core.text.numbers import MINUS, fixed
from seatrial.core.values import Array, display_unit
from seatrial.core.values.notation import unit_text

# How well each direction is determined, and profile likelihoods.

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
    panels = tuple(_profile_panel(p, units.get(p.parameter, "1"), box) for p, box in zip(usable, boxes, strict=True))
    return Chart("profile likelihoods", panels)


def _profile_panel(profile: Profile, unit: str, box: Region) -> Panel:
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


# Draws of each coefficient as a density.

_BINS, _HEADROOM = 30, 1.1
"""Bins of a histogram, and what is drawn above the highest of them, over its height; chosen."""
_OWN, _OTHER = Stroke(SECOND, 0.9), Stroke(SECOND, 0.9, "3 2")  # px, chosen


def posterior_densities(posterior: Posterior) -> Chart:
    """Return a panel for each coefficient with the ends of both intervals."""
    boxes = tiles(len(posterior.coefficients), COLUMNS, HEIGHT, left=54.0, right=10.0, gap=46.0)  # px, chosen
    panels = (
        _density_panel(c, posterior.points[:, :, i].ravel(), box)
        for i, (c, box) in enumerate(zip(posterior.coefficients, boxes, strict=True))
    )
    return Chart("draws of the coefficients", tuple(panels))


def _density_panel(c: CredibleInterval, draws: Array, box: Region) -> Panel:
    factor, unit = display_unit(c.unit)[0], unit_text(c.unit)
    counts, edges = np.histogram(factor * draws, _BINS)
    share = counts / max(np.max(counts), 1)
    ends = [(factor * x, stroke) for x, stroke in
            ((c.lower, _OWN), (c.upper, _OWN), (c.other_lower, _OTHER), (c.other_upper, _OTHER))]  # fmt: skip
    low, high = (pick([pick(edges), *(x for x, _ in ends)]) for pick in (min, max))
    outline = np.repeat(edges, 2), np.concatenate([[0.0], np.repeat(share, 2), [0.0]])
    marks = [Line(*outline, Stroke(ACCENT, 1.4)),  # px, chosen
             *(Line(np.full(2, x), np.array([0.0, 1.0]), stroke) for x, stroke in ends)]  # fmt: skip
    name = f"{c.name} [{unit}]" if unit else c.name
    return Panel(box, Axis((low, high), tick_count=3), Axis((0.0, _HEADROOM), "", tick_count=2), tuple(marks), name)


# Relative errors as dots over a logarithmic axis, a row for each coefficient, manoeuvre or estimator.

# per cent from which on a dot says no more than that there is no information
NO_INFORMATION = 1e4
# least range of the axis [%]: of relative standard errors, of estimators
ERROR_RANGE, ESTIMATOR_RANGE = (1.0, 10.0), (0.1, 100.0)
FILLED = Marker(Shape.CIRCLE, 4.0, ACCENT, ACCENT, 1.4)  # px, chosen
OPEN = Marker(Shape.CIRCLE, 3.4, "#6c7a89", "#ffffff", 1.4)  # px, chosen
TICK = Marker(Shape.UPRIGHT, 6.0, INK, edge_width=1.6)  # px, chosen
_NEAR, _FAR = Marker(Shape.CIRCLE, 3.2, ACCENT, ACCENT), Marker(Shape.CIRCLE, 3.2, SECOND, "#ffffff")  # px, chosen
_MEDIAN, _REACH = Marker(Shape.UPRIGHT, 7.0, INK, edge_width=2.0), Stroke(GREY, 0.7)  # px, chosen


@dataclass(frozen=True)
class ErrorSeries:
    """Errors in per cent for each row, several or none, with their marker."""

    name: str
    rows: Sequence[Sequence[float]]
    marker: Marker


@dataclass(frozen=True)
class CoefficientError:
    """Size of a coefficient's error in per cent, and whether it is within two standard errors of the fit."""

    size: float
    is_near: bool


def error_chart(names: Sequence[str], series: Sequence[ErrorSeries], axis_name: str) -> Chart | None:
    """Return a row for each name with the dots of every series; None without any."""
    finite = [v for one in series for row in one.rows for v in row if 0.0 < v < NO_INFORMATION]
    if not names or not finite:
        return None
    axis = decades_axis(finite, ERROR_RANGE, axis_name, " %")
    marks: list[Mark] = []
    for one in series:
        for row, values in enumerate(one.rows):
            inside = np.array([v for v in values if 0.0 < v < NO_INFORMATION])
            marks.append(Points(inside, np.full(len(inside), float(row)), one.marker))
            marks += [no_information(axis, row)] if any(v >= NO_INFORMATION for v in values) else []
    legend = tuple(LegendEntry(one.name, one.marker) for one in series)
    return Chart(axis_name, (row_panel(names, axis, marks, top=2.0, has_grid=True),), legend)


def estimator_chart(rows: Mapping[str, Mapping[str, CoefficientError]], axis_name: str) -> Chart | None:
    """Return a row of dots for each estimator, a dot a coefficient: the median marked, the largest named.

    Errors below the axis' least value stand at its left edge. None for no rows.
    """
    if not rows:
        return None
    least = ESTIMATOR_RANGE[0]
    axis = decades_axis([max(least, e.size) for row in rows.values() for e in row.values()], ESTIMATOR_RANGE, axis_name,
                        " %")  # fmt: skip
    marks: list[Mark] = []
    for k, row in enumerate(rows.values()):
        sizes = {name: max(least, error.size) for name, error in row.items()}
        marks.append(Line(np.array([min(sizes.values()), max(sizes.values())]), np.full(2, float(k)), _REACH))
        for marker, is_near in ((_NEAR, True), (_FAR, False)):
            x = np.array([sizes[name] for name, error in row.items() if error.is_near is is_near])
            marks.append(Points(x, np.full(len(x), float(k)), marker))
        marks.append(
            Points(np.array([max(least, median(e.size for e in row.values()))]), np.array([float(k)]), _MEDIAN)
        )
        worst = max(sizes, key=lambda name, sizes=sizes: sizes[name])
        marks.append(Text(sizes[worst], k, worst, size=9.0, colour=SECOND, dx=7.0, dy=3.5))  # px, chosen
    return Chart(axis_name, (row_panel(list(rows), axis, marks, top=4.0, right=80.0, has_grid=True),))  # px, chosen
