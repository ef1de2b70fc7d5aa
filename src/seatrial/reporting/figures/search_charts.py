"""What a search did: where its restarts end, how far apart, and how coefficients move while it judges by samples."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Points,
    Rule,
    Shape,
    Stroke,
)
from seatrial.core.figures.panels import NamedCurve, bars_chart, curves_chart, row_panel
from seatrial.core.results import Coefficient, ReferenceEstimate, Search, SearchAttempt, SearchTrack
from seatrial.core.results.comparison import OWN_NAME
from seatrial.core.text.numbers import power_of_ten
from seatrial.core.values import NOTATION, Array, display_unit

# curves in one chart of coefficients, few enough to be distinguished by their dashes
_CURVES_IN_CHART = 4
# least reach of the axis [% of the package's own estimate], and free space beyond the farthest dot
_LEAST_REACH, _MARGIN = 1.0, 1.12
# half widths and widths of the edges of markers [px], chosen
_RESTART = Marker(Shape.CIRCLE, 3.4, ACCENT, "#ffffff", 1.4)
# as above [px]
_USED = Marker(Shape.CIRCLE, 3.4, ACCENT, ACCENT, 1.4)
# as above [px]
_TRUTH = Marker(Shape.DIAMOND, 3.4, SECOND, "#ffffff", 1.4)
# widths of lines [px], chosen
_INTERVAL, _ZERO = Stroke(GREY, 5.0), Stroke(INK, 0.9)


def waterfall_chart(search: Search, reference: ReferenceEstimate) -> Chart | None:
    """Return the weighted rms over the whole record of each restart in order of size, the package's own last."""
    order = sorted(range(len(search.restarts)), key=lambda k: -search.restarts[k].record_rms)
    labels = [*(f"restart {k + 1}" for k in order), OWN_NAME]
    values = [*(search.restarts[k].record_rms for k in order), reference.record_rms]
    return bars_chart("restarts in order of their end", labels, {"": values}, "weighted rms over the whole record")


def attempts_chart(attempts: Sequence[SearchAttempt]) -> Chart | None:
    """Return the loss of each search above the lowest end, at its start and at its end, the best first."""
    series = {"at its start": [a.start_loss for a in attempts], "at its end": [a.loss for a in attempts]}
    labels = [a.origin.partition(":")[0].partition(",")[0] for a in attempts]
    title = "searches from several starting points"
    return bars_chart(title, labels, series, "loss above the lowest", is_logarithmic=True)


def restart_chart(search: Search, reference: ReferenceEstimate) -> Chart | None:
    """Return a row for each coefficient: restarts, interval and known value [% from the package's own estimate]."""
    free = [c for c in reference.coefficients if not c.fixed and c.estimate != 0.0]
    if not free:
        return None
    rows = [[_deviation(c, restart.values[c.name]) for restart in search.restarts] for c in free]
    ends = [abs(_deviation(c, x)) for c in free for x in (c.lower, c.upper, c.truth) if x is not None]
    reach = _MARGIN * max(_LEAST_REACH, *ends, *(abs(x) for row in rows for x in row))
    marks: list[Mark] = [Rule(0.0, _ZERO, is_vertical=True)]
    for k, (c, row) in enumerate(zip(free, rows, strict=True)):
        marks += _own_marks(c, k)
        height = np.full(len(row), float(k))
        marks.append(Points(np.array(row), height, _RESTART))
        marks.append(Points(np.array([row[search.used]]), height[:1], _USED))
    axis = Axis((-reach, reach), "deviation from the package's own estimate, per cent of it", tick_count=8)
    legend = [LegendEntry("restart that is used", _USED)]
    legend += [LegendEntry("other restarts", _RESTART)] if len(search.restarts) > 1 else []
    legend += [LegendEntry(f"95 % interval of {OWN_NAME}", _INTERVAL)] if any(c.lower is not None for c in free) else []
    legend += [LegendEntry("known value", _TRUTH)] if any(c.truth is not None for c in free) else []
    return Chart("values of the restarts", (row_panel([c.name for c in free], axis, marks, top=4.0),), tuple(legend))


def trace_charts(search: Search, reference: ReferenceEstimate) -> tuple[Chart, ...]:
    """Return how the coefficients move from iteration to iteration [% from the package's own estimate]."""
    free = [c for c in reference.coefficients if c.name in search.trace and c.estimate != 0.0]
    groups = [free[k : k + _CURVES_IN_CHART] for k in range(0, len(free), _CURVES_IN_CHART)]
    return tuple(_trace_chart(search, group) for group in groups)


def track_charts(track: SearchTrack, method: str) -> tuple[Chart, ...]:
    """Return each channel over time: recorded, and simulated with the coefficients of each moment."""
    charts = []
    for channel, measured in track.measured.items():
        factor, unit = display_unit(NOTATION[channel].unit)
        series = {"recorded": measured, method: track.tracked[channel], OWN_NAME: track.reference[channel]}
        curves = [NamedCurve(name, track.time, factor * values) for name, values in series.items()]
        charts.append(curves_chart(f"{channel} tracked", curves, "t, s", f"{channel}, {unit}"))
    return tuple(charts)


def value_charts(track: SearchTrack, reference: ReferenceEstimate, method: str) -> tuple[Chart, ...]:
    """Return each coefficient over time, of the search and of the package's own follower, with the known value."""
    charts = []
    for c in reference.coefficients:
        if c.name in track.values:
            series = {method: track.values[c.name], OWN_NAME: track.reference_values[c.name]}
            series |= {} if c.truth is None else {"known": np.full(len(track.time), c.truth)}
            power = _thousands(np.concatenate([*series.values()]))
            curves = [NamedCurve(name, track.time, values / 10.0**power) for name, values in series.items()]
            unit = f"{power_of_ten(power)} {c.unit}" if power else c.unit
            charts.append(curves_chart(c.name, curves, "t, s", f"{c.name}, {unit}"))
    return tuple(charts)


def _thousands(values: Array) -> int:
    """Power of ten, a multiple of three, that leaves the largest value between 1 and 1000."""
    largest = float(np.max(np.abs(values), initial=0.0))
    return 3 * int(np.floor(np.log10(largest) / 3.0)) if largest > 0.0 else 0


def _trace_chart(search: Search, group: Sequence[Coefficient]) -> Chart:
    curves = []
    for c in group:
        away = 100.0 * (np.array(search.trace[c.name]) - c.estimate) / abs(c.estimate)
        curves.append(NamedCurve(c.name, np.arange(1.0, len(away) + 1.0), away))
    title = ", ".join(c.name for c in group)
    return curves_chart(title, curves, "iteration", "deviation from the package's own estimate, %")


def _own_marks(c: Coefficient, row: int) -> list[Mark]:
    """Interval and known value of the package's own estimate."""
    height, marks = np.full(2, float(row)), []
    if c.lower is not None and c.upper is not None:
        marks.append(Line(np.array([_deviation(c, c.lower), _deviation(c, c.upper)]), height, _INTERVAL))
    if c.truth is not None:
        marks.append(Points(np.array([_deviation(c, c.truth)]), height[:1], _TRUTH))
    return marks


def _deviation(c: Coefficient, value: float) -> float:
    """Per cent of the package's own estimate."""
    return 100.0 * (value - c.estimate) / abs(c.estimate)
