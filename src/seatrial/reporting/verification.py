"""The page of a verified controller: predicted beside achieved, the model before and with the log, the legs."""

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.chart import Axis, Chart, LegendEntry, Panel, Region, tiles
from seatrial.core.figures.marks import ACCENT, SECOND, Line, Mark, Marker, Points, Rule, Shape, Stroke
from seatrial.core.figures.rows import row_panel
from seatrial.core.figures.svg_text import svg
from seatrial.core.figures.ticks import span
from seatrial.core.results.verification import Verification, VerifiedLeg
from seatrial.core.text.numbers import exact, fixed
from seatrial.core.values.channel_text import channel_meaning
from seatrial.reporting import verification_text
from seatrial.reporting.document import page_text
from seatrial.reporting.first_screen import FirstScreen
from seatrial.reporting.tables import finding_groups

TITLES = {
    "findings": "Findings",
    "quantities": "Predicted and achieved, legs with control",
    "reductions": "Reduction achieved, by how the sea is accounted for",
    "model": "The model before the log and with it",
    "legs": "Legs, and the sea that explains each",
    "method": "Method and provenance",
}
FOREST_CAPTION = (
    "Achieved over predicted, 95 % intervals of what was achieved; the vertical line is the prediction, its own "
    "interval is in the table. Red: outside."
)
SPECTRA_CAPTION = (
    "Density of the motion over the frequency of encounter: points as logged, line by the model as it was in the sea "
    "that explains the leg."
)
METHOD = (
    "Each leg is cut into half-overlapping segments of twelve natural periods (Welch 1967). Ship and seas are those of "
    "the largest likelihood of the legs' spectra (Whittle), in closed loop as the legs themselves show it, with what "
    "was known of the ship before as prior; heights and periods of neighbouring legs are expected within 10 and 5 %. "
    "The reduction compares the motion with that less the actuator's effect by the model as the log corrects it, so "
    "that the sea of a leg is compared with itself. Intervals join what chance makes of the segments (jackknife) with "
    "the errors of ship and seas."
)
_INSIDE, _OUTSIDE, _ONE = Stroke(ACCENT, 2.0), Stroke(SECOND, 2.0), Stroke("#8a9299", 1.2)  # px, chosen
_DIGITS = 5  # of gains; chosen
_SIZE, _POINT, _HEIGHT, _COLUMNS = 3.2, 2.2, 150.0, 2  # px, px, px, panels side by side; chosen


def html(v: Verification) -> str:
    """Return the page as text; sections without content are left out."""
    findings = finding_groups(v.findings)
    content: dict[str, object] = {"findings": findings}
    figure, caption = Markup(svg(quantity_forest(v))), FOREST_CAPTION
    context = {
        "verification": v,
        "titles": {key: title for key, title in TITLES.items() if content.get(key, True)},
        "screen": FirstScreen(verification_text.verdict(v), verification_text.key_facts(v), figure, caption),
        "gains": [(name, exact(value, _DIGITS)) for name, value in v.gains.items()],
        "findings": findings,
        "quantities": verification_text.quantity_table(v),
        "reductions": verification_text.reduction_table(v),
        "model": verification_text.correction_table(v),
        "legs": verification_text.leg_table(v),
        "spectra": Markup(svg(spectra_chart(v))),
        "spectra_caption": SPECTRA_CAPTION,
        "method": METHOD,
    }
    return page_text("verification.html", context)


def quantity_forest(v: Verification) -> Chart:
    """Return what was achieved over what was predicted, a row for each quantity."""
    marks: list[Mark] = [Rule(1.0, _ONE, is_vertical=True)]
    ratios = [np.array([q.lower, q.achieved, q.upper]) / q.predicted for q in v.quantities]
    for row, (q, (lower, middle, upper)) in enumerate(zip(v.quantities, ratios, strict=True)):
        stroke, place = _INSIDE if q.is_inside else _OUTSIDE, np.full(2, float(row))
        marks.append(Line(np.array([lower, upper]), place, stroke))
        marker = Marker(Shape.CIRCLE, _SIZE, stroke.colour, stroke.colour, 0.0)
        marks.append(Points(np.array([middle]), place[:1], marker))
    axis = Axis(span([np.concatenate([*ratios, np.ones(1)])]), "achieved over predicted", tick_count=7)
    return Chart("predicted and achieved", (row_panel([q.name for q in v.quantities], axis, marks, top=4.0),))


def spectra_chart(v: Verification) -> Chart:
    """Return the motion's density of each leg, logged and by the model as it was."""
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
