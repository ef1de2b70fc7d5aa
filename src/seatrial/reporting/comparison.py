"""The page of two fits compared: what changed, coefficients, manoeuvres; nothing is computed."""

import math
from collections.abc import Callable, Sequence

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
    Points,
    Rule,
    Shape,
    Stroke,
    span,
)
from seatrial.core.figures.panels import row_panel
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Comparison, Difference, ManoeuvreDifferences
from seatrial.core.text.numbers import DASH, SMALLEST, exact, exponent, fixed, p_value, power_of_ten, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import Severity
from seatrial.reporting.document import chapters_page
from seatrial.reporting.measures import manoeuvre_name, simulated_measure_label
from seatrial.reporting.model_chapter import version_section
from seatrial.reporting.section import FirstScreen, KeyFact, Level, Section, TextTable, finding_section, plain_table

_AGREES, _DIFFERS, _ZERO = Stroke(ACCENT, 2.0), Stroke(SECOND, 2.0), Stroke("#8a9299", 1.2)  # px, chosen
_SIZE = 3.2  # px, chosen
_HEADER = ("", "first", "second", "difference", "95 % from", "to", "")
_SIGNIFICANCE = 0.05
"""p-value below which coefficients differ, as the intervals have it."""
_MOST_DIGITS = 6  # of a value, chosen
_NOTE = (
    "Second minus first; the interval has the errors of both in it. Differs: zero lies outside the joint 95 % interval "
    "of the table (Bonferroni)."
)


def sections(comparison: Comparison) -> tuple[Section, ...]:
    """Return the chapters of a comparison that have content, in order."""
    first, second = comparison.first, comparison.second
    properties = {
        "Fit": (first.name, second.name),
        "Ship": (first.ship, second.ship),
        "Model": (first.model, second.model),
        "Training runs": (", ".join(first.records), ", ".join(second.records)),
        "Criterion": (first.criterion, second.criterion),
        "Intervals": (first.intervals, second.intervals),
    }
    fits = plain_table(
        ("", "first", "second"), [(name, *values) for name, values in properties.items()], flush_left=(0, 1, 2)
    )
    chapters = (
        Section("The two fits", "fits", table=fits, level=Level.PAGE),
        Section("What else changed", "changes", points=comparison.changes),
        Section("Coefficients", "coefficients", table=difference_table(comparison.coefficients), note=_NOTE),
        Section("Manoeuvres", "manoeuvres", parts=tuple(map(manoeuvre_section, comparison.manoeuvres))),
        finding_section(comparison.findings),
        version_section(comparison.versions),
    )
    return tuple(chapter for chapter in chapters if chapter)


def html(comparison: Comparison) -> str:
    """Return the page as text; chapters without content are left out."""
    names = f"{comparison.first.name} and {comparison.second.name}"
    return chapters_page(
        "Comparison of two fits", names, first_screen(comparison), sections(comparison), title=f"{names} compared"
    )


def first_screen(comparison: Comparison) -> FirstScreen:
    """Return whether the fits differ, in what, and the differences as a picture."""
    first, *rest = outcome(comparison)
    significant_ones = [d for d in comparison.coefficients if d.is_significant]
    measures = [d for m in comparison.manoeuvres for d in m.measures]
    differing = sum(bool(d.is_significant) for d in measures)
    warned = [f.code for f in comparison.findings if f.severity is not Severity.INFO]
    facts = (
        KeyFact("What differs", " ".join(rest) or "nothing else", "coefficients"),
        KeyFact("Coefficients", f"{len(significant_ones)} of {len(comparison.coefficients)} differ", "coefficients"),
        KeyFact("Manoeuvres", f"{differing} of {counted(len(measures), 'value')} differ",
                "manoeuvres" if comparison.manoeuvres else ""),
        KeyFact("What else changed", counted(len(comparison.changes), "fact") if comparison.changes else "nothing",
                "changes" if comparison.changes else "", None if comparison.changes else True),
        KeyFact("Warnings", enumeration(warned) or "none", "findings" if comparison.findings else "", not warned),
    )  # fmt: skip
    caption = "Second minus first, with the errors of both; intervals that reach the edge go on beyond it."
    return FirstScreen(first, facts, Markup(svg(difference_forest(comparison.coefficients))), caption)


def outcome(comparison: Comparison) -> list[str]:
    """Return the summary in sentences: coefficients together, one by one, then manoeuvres."""
    sentences = []
    test = comparison.joint_test
    if test is not None:
        verdict = "differ" if test.p < _SIGNIFICANCE else "do not differ significantly"
        sentences.append(
            f"Taken together, the {counted(len(comparison.coefficients), 'coefficient')} {verdict} "
            f"(χ² {exact(test.statistic, 3)} with {test.degrees_of_freedom} degrees of freedom, {p_value(test.p)})."
        )
    apart = [d for d in comparison.coefficients if d.is_significant]
    if apart:
        sentences.append(f"Significant one by one: {enumeration([_clause(d) for d in apart])}.")
    for m in comparison.manoeuvres:
        differing = sorted((d for d in m.measures if d.is_significant), key=_clearness, reverse=True)
        if differing:
            more = f" and {len(differing) - 1} more of {counted(len(m.measures), 'value')}" if differing[1:] else ""
            sentences.append(f"{_title(m)}: {_measure_clause(differing[0])}{more}.")
    if not sentences or (not apart and not any(d.is_significant for m in comparison.manoeuvres for d in m.measures)):
        sentences.append("No single quantity differs significantly.")
    return sentences


def _clause(d: Difference) -> str:
    """A coefficient with both values."""
    return f"{d.name} {exact(d.first, 3)} → {exact(d.second, 3)}"


def _measure_clause(d: Difference) -> str:
    """A measure with both values, in the digits of its table, and its unit."""
    label, unit = simulated_measure_label(d.name)
    _, first, second, *_ = _row(d, (label, unit))
    return f"{label} {first} → {second} {unit}".strip()


def _clearness(d: Difference) -> float:
    """How often a difference holds the width of its interval; 0 where it has none."""
    if d.difference is None or d.lower is None or d.upper is None or d.upper <= d.lower:
        return 0.0
    return abs(d.difference) / (d.upper - d.lower)


def difference_table(rows: Sequence[Difference], label: Callable[[str], tuple[str, str]] | None = None) -> TextTable:
    """Return differences as text; label: name and unit in which a quantity is read, None: its own."""
    return plain_table(_HEADER, [_row(d, label(d.name) if label else None) for d in rows], flush_left=(0, -1))


def manoeuvre_section(m: ManoeuvreDifferences) -> Section:
    """Return the differences of a manoeuvre's measures."""
    missing = () if m.measures else (sentence(m.note or "no measure in common"),)
    table = difference_table(m.measures, simulated_measure_label)
    return Section(_title(m), sentences=missing, table=table, note=m.note if m.measures else "")


def _title(m: ManoeuvreDifferences) -> str:
    return sentence(manoeuvre_name(m.manoeuvre)).removesuffix(".")


def _row(d: Difference, label: tuple[str, str] | None = None) -> tuple[str, ...]:
    """Values and their difference with the digits that the difference's interval allows."""
    name, unit = label or (d.name, "" if d.unit == "1" else d.unit)
    named = f"{name}, {unit}" if unit else name
    width = None if d.lower is None or d.upper is None else d.upper - d.lower
    values = (DASH if v is None else _value_text(v, width) for v in (d.first, d.second))
    return named, *values, *_difference_texts(d, width), "differs" if d.is_significant else ""


def _difference_texts(d: Difference, width: float | None) -> tuple[str, ...]:
    """The difference and its interval, all to two digits of half the interval."""
    if not width:
        return tuple("" if v is None else significant(v, 2) for v in (d.difference, d.lower, d.upper))
    power = exponent(0.5 * width, 2)
    scale, unit = (1.0, "") if 0.5 * width >= SMALLEST else (10.0**power, power_of_ten(power))
    decimals = max(0, 1 - power) if scale == 1.0 else 1
    ends = (d.difference, d.lower, d.upper)
    return tuple("" if v is None else fixed(v / scale, decimals) + unit for v in ends)


def _value_text(value: float, width: float | None) -> str:
    """Digits down to a tenth of the interval's width; four where that is not known."""
    if not width or not value:
        return significant(value, 4)
    digits = 1 + math.ceil(math.log10(max(abs(value) / width, 1.0)))
    return significant(value, min(max(digits, 2), _MOST_DIGITS))


def difference_forest(rows: Sequence[Difference]) -> Chart | None:
    """Return each difference with its interval [% of the first value]; None where there is none."""
    usable = [d for d in rows if d.first and d.difference is not None and d.lower is not None and d.upper is not None]
    if not usable:
        return None
    shares = [[100.0 * v / abs(d.first or 1.0) for v in (d.lower, d.difference, d.upper) if v is not None]
              for d in usable]  # fmt: skip
    marks: list[Mark] = [Rule(0.0, _ZERO, is_vertical=True)]
    for row, (d, (lower, middle, upper)) in enumerate(zip(usable, shares, strict=True)):
        stroke, place = _DIFFERS if d.is_significant else _AGREES, np.full(2, float(row))
        marks.append(Line(np.array([lower, upper]), place, stroke))
        marker = Marker(Shape.CIRCLE, _SIZE, stroke.colour, stroke.colour, 0.0)
        marks.append(Points(np.array([middle]), place[:1], marker))
    largest = float(np.median([abs(s) for share in shares for s in share])) or 1.0
    ends = span([np.clip(np.array([s for share in shares for s in share] + [0.0]), -_CUT * largest, _CUT * largest)])
    axis = Axis(ends, "difference, per cent of the first", tick_count=7)
    legend = (LegendEntry("95 % interval", _AGREES),)
    if any(d.is_significant for d in usable):
        legend += (LegendEntry("differs (joint 95 %)", _DIFFERS),)
    return Chart(
        "differences of the coefficients", (row_panel([d.name for d in usable], axis, marks, top=4.0),), legend
    )


_CUT = 6.0
"""Ends of the axis over the median size of the ends of intervals, at most: wide ones run out of the picture; chosen."""
