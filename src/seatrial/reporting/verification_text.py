"""A verification in sentences and tables; page and terminal share them."""

import math

from seatrial.core.results.verification import ModelCorrection, Verification, VerifiedLeg, VerifiedQuantity
from seatrial.core.text.numbers import DASH, exact, fixed, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Severity, display_unit
from seatrial.core.values.notation import channel_meaning
from seatrial.reporting.first_screen import KeyFact
from seatrial.reporting.section import Picture, Section, plain_table

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
        f"{_agreement(reduction)}: the model says {predicted} % in the sea that was met."
    )


def _changes_verdict(v: Verification) -> str:
    overshoot, settling = v.quantities[:2]
    share, least, most = (fixed(100.0 * x, 1) for x in (
        overshoot.achieved, overshoot.predicted_lower, overshoot.predicted_upper))  # fmt: skip
    time, first, last = (significant(x, _DIGITS) for x in (
        settling.achieved, settling.predicted_lower, settling.predicted_upper))  # fmt: skip
    return (
        f"Changes of the {channel_meaning(v.output)} overshoot by {share} %, {_agreement(overshoot)} ({least} to "
        f"{most} %), and settle in {time} s, {_agreement(settling)} ({first} to {last} s)."
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
        KeyFact("Inside", f"{inside} of {len(v.quantities)} quantities", "quantities", not v.outside),
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
