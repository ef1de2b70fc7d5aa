"""The page and the terminal of a verification."""

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
from seatrial.core.results.verification import ModelCorrection, Verification, VerifiedLeg, VerifiedQuantity
from seatrial.core.text.numbers import DASH, exact, fixed, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Severity, display_unit
from seatrial.core.values.notation import channel_meaning
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.reporting.document import chapters_page
from seatrial.reporting.model_chapter import version_text
from seatrial.reporting.section import (
    FirstScreen,
    KeyFact,
    Level,
    Picture,
    Section,
    fact_table,
    finding_section,
    plain_table,
)

# A verification in sentences and tables; page and terminal share them.

_DIGITS = 3  # of values; chosen


def verdict(v: Verification) -> str:
    """Return what was achieved of what was predicted, in a sentence."""
    return _changes_verdict(v) if v.changes else _legs_verdict(v)


def _legs_verdict(v: Verification) -> str:
    reduction = v.quantities[0]
    achieved, low, high, predicted = (
        fixed(100.0 * x, 1) for x in (reduction.achieved, reduction.lower, reduction.upper, reduction.predicted)
    )
    return (
        f"The controller took {achieved} % off the {channel_meaning(v.output)} (95 % interval {low} to {high} %), "
        f"{_agreement(reduction)}: the model says {predicted} %."
    )


def _changes_verdict(v: Verification) -> str:
    overshoot, settling = v.quantities[:2]
    share, least, most = (fixed(100.0 * x, 1) for x in (
        overshoot.achieved, overshoot.predicted_lower, overshoot.predicted_upper))  # fmt: skip
    time, first, last = (significant(x, _DIGITS) for x in (
        settling.achieved, settling.predicted_lower, settling.predicted_upper))  # fmt: skip
    return (
        f"Changes of the {channel_meaning(v.output)} overshoot by {share} % (predicted {least} to {most} %) and settle "
        f"in {time} s (predicted {first} to {last} s)."
    )


def _agreement(q: VerifiedQuantity) -> str:
    return "as predicted" if q.is_inside else "not as predicted"


def key_facts(v: Verification) -> tuple[KeyFact, ...]:
    """Return the rows at the top."""
    moved = [f"{c.name}: {exact(c.model, _DIGITS)} → {exact(c.log, _DIGITS)}" for c in v.corrections if c.is_moved]
    warned = list(dict.fromkeys(f.code for f in v.findings if f.severity is not Severity.INFO))
    inside = len(v.quantities) - len(v.outside)
    unmoved = "no property moved beyond its interval" if v.corrections else "not estimated anew"
    return (
        KeyFact("Inside", f"{inside} of {len(v.quantities)} quantities", "quantities", inside > 0 and not v.outside),
        *([KeyFact("Outside", enumeration(v.outside), "quantities", False)] if v.outside else []),
        KeyFact("Model", "; ".join(moved) or unmoved, "model" if v.corrections else "",
                not moved if v.corrections else None),
        _extent_fact(v),
        KeyFact("Warnings", enumeration(warned) or "none", "findings" if v.findings else "", not warned),
    )  # fmt: skip


def _extent_fact(v: Verification) -> KeyFact:
    """Return how many legs or changes the log holds."""
    if v.changes:
        return KeyFact("Changes", str(len(v.changes)), "changes")
    on = sum(leg.is_controlled for leg in v.legs)
    is_enough = None if on < len(v.legs) else False
    return KeyFact("Legs", f"{on} with control, {len(v.legs) - on} without", "legs", is_enough)


def quantity_section(v: Verification) -> Section:
    """Return predicted and achieved values with their intervals."""
    header = ("", "unit", "predicted", "95 % interval", "achieved", "95 % interval", "")
    return Section(
        "Predicted and achieved" if v.changes else "Predicted and achieved, legs with control",
        "quantities",
        table=plain_table(header, map(_quantity_row, v.quantities), flush_left=(0, 1, -1)),
        note=_CHANGES_NOTE if v.changes else _LEGS_NOTE,
    )


_LEGS_NOTE = (
    "Predicted: by the model as it was, in the seas that explain the legs. Inside: the 95 % interval of the difference "
    "includes zero."
)
_CHANGES_NOTE = (
    "Means over the changes. Predicted: by ships drawn from the fit, with the log's own weather on top, median and "
    "95 % interval. Inside: what was achieved lies in it."
)


def _quantity_row(q: VerifiedQuantity) -> tuple[str, ...]:
    factor, unit = (100.0, "%") if q.unit == "1" else _rate_unit(q.unit)
    low, high, lower, upper = (factor * x for x in (q.predicted_lower, q.predicted_upper, q.lower, q.upper))
    return (
        q.name, unit, significant(factor * q.predicted, _DIGITS), _ends(low, high),
        significant(factor * q.achieved, _DIGITS), _ends(lower, upper), "inside" if q.is_inside else "outside",
    )  # fmt: skip


def _rate_unit(unit: str) -> tuple[float, str]:
    """Return factor and unit for reading, of an angle or its rate."""
    base = unit.removesuffix("/s")
    factor, shown = display_unit(base)
    return factor, shown + unit.removeprefix(base)


def _ends(lower: float, upper: float) -> str:
    """Return an interval; a dash where there is none."""
    if math.isnan(lower + upper):
        return DASH
    return f"{significant(lower, _DIGITS)} to {significant(upper, _DIGITS)}"


def reduction_section(v: Verification) -> Section:
    """Return the reduction by each way to correct for the sea."""
    rows = [
        (r.method, fixed(100.0 * r.value, 1), f"{fixed(100.0 * r.lower, 1)} to {fixed(100.0 * r.upper, 1)}")
        for r in v.reductions
    ]
    title = "Reduction achieved, by how the sea is accounted for"
    return Section(title, "reductions", table=plain_table(("", "%", "95 % interval"), rows))


def correction_section(v: Verification) -> Section:
    """Return the plant's properties before the log and with it."""
    header = ("", "unit", "model", "± before", "with the log", "95 % interval", "")
    return Section(
        "The model before the log and with it",
        "model",
        table=plain_table(header, map(_correction_row, v.corrections), flush_left=(0, 1, -1)),
        note=f"Before: standard deviation, {_PRIOR_OF_CHANGES if v.changes else _PRIOR_OF_LEGS}. With the log: what "
        "was known before is the prior. Moved: the model's value lies outside the interval.",
    )


_PRIOR_OF_LEGS, _PRIOR_OF_CHANGES = "of [uncertainty] in the loop file; damping 30 %", "of the model's covariance"


def _correction_row(c: ModelCorrection) -> tuple[str, ...]:
    model, deviation, log = (significant(x, _DIGITS) for x in (c.model, c.deviation, c.log))
    unit = "" if c.unit == "1" else c.unit
    return c.name, unit, model, deviation, log, _ends(c.lower, c.upper), "moved" if c.is_moved else "held"


def leg_section(v: Verification, pictures: tuple[Picture, ...]) -> Section:
    """Return the legs with the sea that explains each."""
    (factor, unit), (actuator_factor, actuator_unit) = (_channel_unit(name) for name in (v.output, v.actuator))
    header = ("record", "from s", "to s", "control", "height m", "95 % interval", "peak s", "95 % interval",
              f"{v.output} {unit}", f"{v.actuator} {actuator_unit}", "of its orders")  # fmt: skip
    return Section(
        "Legs, and the sea that explains each",
        "legs",
        table=plain_table(header, [_leg_row(leg, factor, actuator_factor) for leg in v.legs], flush_left=(0, 3)),
        note="Last columns: rms, and what the actuator did over what the gains order of the output.",
        pictures=pictures,
    )


def _channel_unit(symbol: str) -> tuple[float, str]:
    from seatrial.data.folder.gains_file import channel_display_unit

    return channel_display_unit(symbol)


def _leg_row(leg: VerifiedLeg, factor: float, actuator_factor: float) -> tuple[str, ...]:
    return (
        leg.record, fixed(leg.start, 0), fixed(leg.stop, 0), "on" if leg.is_controlled else "off",
        significant(leg.height, _DIGITS), _ends(leg.height_lower, leg.height_upper),
        significant(leg.period, _DIGITS), _ends(leg.period_lower, leg.period_upper),
        significant(factor * leg.output_rms, _DIGITS), significant(actuator_factor * leg.actuator_rms, _DIGITS),
        DASH if math.isnan(leg.gain_ratio) else fixed(leg.gain_ratio, 2),
    )  # fmt: skip


def change_section(v: Verification, pictures: tuple[Picture, ...]) -> Section:
    """Return each change: overshoot and settling, predicted without weather and achieved."""
    factor, unit = _channel_unit(v.output)
    rows = [
        (
            c.record, fixed(c.start, 0), significant(factor * c.change, _DIGITS),
            fixed(100.0 * c.predicted_overshoot, 1), fixed(100.0 * c.overshoot, 1),
            significant(c.predicted_settling, _DIGITS), significant(c.settling, _DIGITS),
        )
        for c in v.changes
    ]  # fmt: skip
    header = ("record", "at s", f"change {unit}", "overshoot % predicted", "achieved", "settling s predicted",
              "achieved")  # fmt: skip
    return Section(
        "Changes one by one",
        "changes",
        table=plain_table(header, rows),
        note="Predicted by the model as it was, without weather.",
        pictures=pictures,
    )


# The page of a verified controller: predicted beside achieved, the model before and with the log, the legs.

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
_GAIN_DIGITS = 5  # of gains; chosen
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
        quantity_section(v),
        reduction_section(v),
        correction_section(v),
        leg_section(v, (spectra,) if v.legs else ()),
        change_section(v, (courses,) if v.changes else ()),
        finding_section(v.findings),
        method,
    )
    return tuple(chapter for chapter in chapters if chapter)


def html(v: Verification) -> str:
    """Return the page as text; chapters without content are left out."""
    screen = FirstScreen(
        verdict(v), key_facts(v), Markup(svg(quantity_forest(v))),
        CHANGES_FOREST_CAPTION if v.changes else FOREST_CAPTION, gains_title="Gains that were on",
        gains=tuple((name, exact(value, _GAIN_DIGITS)) for name, value in v.gains.items()),
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
