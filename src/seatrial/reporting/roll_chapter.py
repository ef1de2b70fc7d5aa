"""The chapter on roll: what the coefficients mean, as tables and a figure."""

import math

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Curve, Figure, RollCharacteristics
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.text.numbers import DASH, estimate_text, fixed, significant
from seatrial.reporting.figures.roll_damping import roll_damping_chart
from seatrial.reporting.figures.study_figures import study_chart
from seatrial.reporting.text_tables import TextTable

# amplitudes in the table; degrees of a radian
_AMPLITUDES, _DEGREES = 5, math.degrees(1.0)
_WHOLE_RANGE = " The range of GM has the whole range of the radius in it."


def tables(roll: RollCharacteristics, scale: float) -> list[TextTable]:
    """Return derived quantities, at full scale too by Froude's law, and swings of some amplitudes."""
    rows = [
        ("natural period at small angles, s", roll.natural_period, math.sqrt(scale)),
        ("linear damping, share of critical, %", roll.damping_ratio.scaled(100.0), 1.0),
        ("metacentric height GM, m", roll.metacentric_height, scale),
        ("radius of gyration with added inertia, m", roll.gyradius, scale),
    ]
    has_scale = scale != 1.0
    header = ("Quantity", "estimate", "95 % from", "to", *(("at full scale",) if has_scale else ()))
    quantities = tuple(
        _quantity_row(name, value, factor, has_scale=has_scale) for name, value, factor in rows if value is not None
    )
    height, radius = roll.metacentric_height, roll.gyradius
    ranges = height is not None and radius is not None and height.lower < height.upper and radius.lower < radius.upper
    note = f"Inertia: {roll.gyradius_source}.{_WHOLE_RANGE if ranges else ''}"
    first = TextTable("What the coefficients mean", header, _numeric_columns(header), quantities, note)
    return [first, _amplitude_table(roll)] if roll.amplitude else [first]


def _quantity_row(name: str, value: IntervalEstimate, factor: float, *, has_scale: bool) -> tuple[str, ...]:
    """Digits by the width of the interval; a value taken as exact has no interval to show."""
    error = 0.5 * (value.upper - value.lower)
    text, full = estimate_text(value.value, error, value.lower, value.upper), value.scaled(factor)
    bounds = (text.lower, text.upper) if error > 0.0 else (DASH, DASH)
    cells = (name, text.value, *bounds)
    return (*cells, estimate_text(full.value, factor * error, full.lower, full.upper).value) if has_scale else cells


def _numeric_columns(header: tuple[str, ...]) -> tuple[bool, ...]:
    return (False, *(True for _ in header[1:]))


def _amplitude_table(roll: RollCharacteristics) -> TextTable:
    places = np.linspace(0, len(roll.amplitude) - 1, _AMPLITUDES + 1).round().astype(int)[1:]
    rows = tuple(
        (
            fixed(math.degrees(roll.amplitude[i]), 1),
            significant(roll.period[i], 4),
            *(significant(b[i], 3) for b in (roll.damping, roll.damping_lower, roll.damping_upper)),
            significant(100.0 * share_of_critical(roll.damping[i], roll.period[i]), 2),
        )
        for i in places
    )
    header = ("Amplitude, deg", "period, s", "equivalent damping, 1/s", "95 % from", "to", "share of critical, %")
    note = (
        "Equivalent: the linear damping that takes as much energy in a swing, b₁ + 8/(3π) ω a b₂ + ¾ ω² a² b₃ (Himeno "
        "1981; ITTC 7.5-02-07-04.5)."
    )
    return TextTable("Swings of some amplitudes", header, (True, *_numeric_columns(header)[1:]), rows, note)


def share_of_critical(damping: float, period: float) -> float:
    """Return the equivalent damping b_e [1/s] of swings of a period T [s] over the critical, b_e / (2 w)."""
    return damping * period / (4.0 * math.pi)


def figures(roll: RollCharacteristics) -> list[tuple[Markup, Figure]]:
    """Return damping and period over amplitude, or the spectrum of roll."""
    note = "Equivalent linear damping and period over the amplitude of a swing, the model with its 95 % band."
    if roll.swings:
        note += " Dots: each recorded swing on its own, with damping 2 ln(aᵢ / aᵢ₊₂) / T, independent of the model."
    if roll.spectrum:
        return [_spectrum_figure(roll)]
    picture = svg(roll_damping_chart(roll))
    return [(Markup(picture), Figure("Damping and period", "", "", (), note))] if picture else []


def _spectrum_figure(roll: RollCharacteristics) -> tuple[Markup, Figure]:
    """Recorded and expected density of roll."""
    omega, recorded, expected = (np.array(column) for column in zip(*roll.spectrum, strict=True))
    lines = (
        Curve("recorded, smoothed", omega, _DEGREES**2 * recorded),
        Curve("expected", omega, _DEGREES**2 * expected),
    )
    note = "The sea's own spectrum, of one peak, is estimated with natural period and damping."
    figure = Figure("Spectrum of roll", "frequency, rad/s", "deg\u00b2 s/rad", lines, note)
    return Markup(svg(study_chart(figure))), figure
