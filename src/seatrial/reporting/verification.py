"""The page of a verified controller: predicted beside achieved, the model before and with the log, the legs."""

import math

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.chart import (
    ACCENT,
    SECOND,
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
    span,
    tiles,
)
from seatrial.core.figures.panels import row_panel
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.verification import Verification, VerifiedLeg, VerifiedQuantity
from seatrial.core.text.numbers import exact, fixed
from seatrial.core.values import Array
from seatrial.core.values.notation import channel_meaning
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.reporting import verification_text
from seatrial.reporting.document import chapters_page
from seatrial.reporting.finding_chapter import finding_section
from seatrial.reporting.first_screen import FirstScreen
from seatrial.reporting.model_chapter import version_text
from seatrial.reporting.section import Level, Picture, Section, fact_table

FOREST_CAPTION = (
    "Achieved over predicted, 95 % intervals of what was achieved; the vertical line is the prediction, its own "
    "interval is in the table. Red: outside."
)
CHANGES_FOREST_CAPTION = (
    "Over the prediction: 95 % interval of the prediction, and as a point what was achieved. Red: outside."
)
CHANGES_CAPTION = (
    "Each change from its order on: as logged, by the model as it was without weather, and the order (dashed)."
)
CHANGES_METHOD = (
    "Changes are found in the channel of what was ordered. Each is simulated by the nonlinear model within the "
    "actuator's limits, and by ships drawn from the covariance of the fit. What weather does is taken from the log, "
    "where the changes had settled, and laid over the simulations. Motions are averaged over half of the reference's "
    "time constant before overshoot and settling are read, of predictions too. The model is estimated anew from the "
    "log by the estimator of identify, with its covariance as prior."
)
SPECTRA_CAPTION = (
    "Density of the motion over the frequency of encounter: points as logged, line by the model as it was in the sea "
    "that explains the leg."
)
METHOD = (
    "Each leg is cut into half-overlapping segments of twelve natural periods (Welch 1967). Ship and seas are those of "
    "the largest likelihood of the legs' spectra (Whittle) in closed loop, with what was known of the ship as prior. "
    "Heights and periods of neighbouring legs are expected within 10 and 5 %. "
    "The reduction compares the motion with that less the actuator's effect by the model as the log corrects it, so "
    "that the sea of a leg is compared with itself. Intervals join what chance makes of the segments (jackknife) with "
    "the errors of ship and seas."
)
_INSIDE, _OUTSIDE, _ONE = Stroke(ACCENT, 2.0), Stroke(SECOND, 2.0), Stroke("#8a9299", 1.2)  # px, chosen
_ORDER = Stroke("#8a9299", 1.2, "5 3")  # px, chosen
_DIGITS = 5  # of gains; chosen
_SIZE, _POINT, _HEIGHT, _COLUMNS = 3.2, 2.2, 150.0, 2  # px, px, px, panels side by side; chosen


def sections(v: Verification) -> tuple[Section, ...]:
    """Return the chapters of a verification that have content, in order."""
    spectra = Picture(lambda: svg(spectra_chart(v)), SPECTRA_CAPTION)
    courses = Picture(lambda: svg(changes_chart(v)), CHANGES_CAPTION)
    method = Section(
        "Method",
        "method",
        sentences=(CHANGES_METHOD if v.changes else METHOD,),
        table=fact_table({"Plant": v.plant, "Versions": version_text(v.versions)}),
        level=Level.PAGE,
        is_folded=True,
    )
    chapters = (
        verification_text.quantity_section(v),
        verification_text.reduction_section(v),
        verification_text.correction_section(v),
        verification_text.leg_section(v, (spectra,) if v.legs else ()),
        verification_text.change_section(v, (courses,) if v.changes else ()),
        finding_section(v.findings),
        method,
    )
    return tuple(chapter for chapter in chapters if chapter)


def html(v: Verification) -> str:
    """Return the page as text; chapters without content are left out."""
    screen = FirstScreen(
        verification_text.verdict(v), verification_text.key_facts(v), Markup(svg(quantity_forest(v))),
        CHANGES_FOREST_CAPTION if v.changes else FOREST_CAPTION, gains_title="Gains that were on",
        gains=tuple((name, exact(value, _DIGITS)) for name, value in v.gains.items()),
    )  # fmt: skip
    name = f"{v.name[:1].upper()}{v.name[1:]}"
    return chapters_page("Verified controller", name, screen, sections(v), title=f"{v.name}: verified")


def quantity_forest(v: Verification) -> Chart:
    """Return what was achieved over what was predicted, a row for each quantity."""
    marks: list[Mark] = [Rule(1.0, _ONE, is_vertical=True)]
    shown = [q for q in v.quantities if q.predicted > 0.0]
    ratios = [_interval(q) / q.predicted for q in shown]
    for row, (q, (lower, middle, upper)) in enumerate(zip(shown, ratios, strict=True)):
        stroke, place = _INSIDE if q.is_inside else _OUTSIDE, np.full(2, float(row))
        marks.append(Line(np.array([lower, upper]), place, stroke))
        marker = Marker(Shape.CIRCLE, _SIZE, stroke.colour, stroke.colour, 0.0)
        marks.append(Points(np.array([middle]), place[:1], marker))
    axis = Axis(span([np.concatenate([*ratios, np.ones(1)])]), "achieved over predicted", tick_count=7)
    return Chart("predicted and achieved", (row_panel([q.name for q in shown], axis, marks, top=4.0),))


def _interval(q: VerifiedQuantity) -> Array:
    """Return lower end, achieved value and upper end; ends of the prediction where there are no others."""
    ends = (q.predicted_lower, q.predicted_upper) if math.isnan(q.lower) else (q.lower, q.upper)
    return np.array([ends[0], q.achieved, ends[1]])


def changes_chart(v: Verification) -> Chart | None:
    """Return the output of each change over time, logged and by the model, with the order; None without changes."""
    if not v.changes:
        return None
    factor, unit = channel_display_unit(v.output)
    boxes = tiles(len(v.changes), _COLUMNS, _HEIGHT, left=58.0, right=12.0, gap=58.0)  # px, chosen
    panels = []
    for box, c in zip(boxes, v.changes, strict=True):
        time: Array = c.dt * np.arange(len(c.order), dtype=np.float64)
        series = ((c.order, _ORDER), (c.measured, _OUTSIDE), (c.predicted, _INSIDE))
        marks = tuple(Line(time, factor * values, stroke) for values, stroke in series)
        ends = span([factor * values for values, _ in series])
        y = Axis(ends, f"{v.output} [{unit}]")
        panels.append(Panel(box, Axis((0.0, float(time[-1])), "time from the order [s]"), y, marks,
                            f"{c.record}, {fixed(c.start, 0)} s"))  # fmt: skip
    legend = (LegendEntry("as logged", _OUTSIDE), LegendEntry("by the model as it was", _INSIDE),
              LegendEntry("ordered", _ORDER))  # fmt: skip
    return Chart(f"changes of the {channel_meaning(v.output)}", tuple(panels), legend)


def spectra_chart(v: Verification) -> Chart | None:
    """Return the motion's density of each leg, logged and by the model as it was; None without legs."""
    if not v.legs:
        return None
    boxes = tiles(len(v.legs), _COLUMNS, _HEIGHT, left=58.0, right=12.0, gap=58.0)  # px, chosen
    panels = tuple(_spectrum_panel(box, leg, v.output) for box, leg in zip(boxes, v.legs, strict=True))
    legend = (
        LegendEntry("as logged", Marker(Shape.CIRCLE, _POINT, SECOND, SECOND, 0.0)),
        LegendEntry("by the model as it was", _INSIDE),
    )
    return Chart(f"spectra of the {channel_meaning(v.output)}", panels, legend)


def _spectrum_panel(box: Region, leg: VerifiedLeg, output: str) -> Panel:
    factor = np.degrees(1.0) ** 2
    x = Axis((float(leg.omega[0]), float(leg.omega[-1])), "ω of encounter [rad/s]")
    top = 1.1 * factor * float(max(leg.measured.max(), leg.predicted.max()))  # room above the largest; chosen
    marks = (
        Line(leg.omega, factor * leg.predicted, _INSIDE),
        Points(leg.omega, factor * leg.measured, Marker(Shape.CIRCLE, _POINT, SECOND, SECOND, 0.0)),
    )
    title = f"{leg.record}, {fixed(leg.start, 0)} s, control {'on' if leg.is_controlled else 'off'}"
    return Panel(box, x, Axis((0.0, top), f"{output} [deg² s/rad]"), marks, title)
