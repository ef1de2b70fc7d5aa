"""Relative errors as dots over a logarithmic axis, a row for each coefficient, manoeuvre or estimator."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Points,
    Shape,
    Stroke,
    Text,
)
from seatrial.core.figures.panels import decades_axis, no_information, row_panel

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
