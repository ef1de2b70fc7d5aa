"""The chapter on roll: what the coefficients mean, as tables and a figure."""

import math
from functools import partial

import numpy as np

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Curve, Figure, RollCharacteristics
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.text.numbers import DASH, estimate_text, fixed, significant
from seatrial.reporting.figures.roll_damping import roll_damping_chart
from seatrial.reporting.figures.study_figures import study_chart
from seatrial.reporting.section import Level, Picture, Section, TextTable, number, plain_table, table_of

# amplitudes in the table; degrees of a radian
_AMPLITUDES, _DEGREES = 5, math.degrees(1.0)
_WHOLE_RANGE = " The range of GM has the whole range of the radius in it."


def roll_section(roll: RollCharacteristics | None, scale: float) -> Section:
    """Return the chapter on what the coefficients of a roll model mean; empty for any other model."""
    if roll is None:
        return Section("")
    height, radius = roll.metacentric_height, roll.gyradius
    ranges = height is not None and radius is not None and height.lower < height.upper and radius.lower < radius.upper
    return Section(
        "Roll: period, damping, metacentric height",
        "rolling",
        table=_quantities(roll, scale),
        note=f"Inertia: {roll.gyradius_source}.{_WHOLE_RANGE if ranges else ''}",
        pictures=(_picture(roll),),
        parts=(_swings(roll),) if roll.amplitude else (),
        level=Level.PAGE,
    )


def _quantities(roll: RollCharacteristics, scale: float) -> TextTable:
    """Derived quantities, at full scale too by Froude's law."""
    rows = [
        ("natural period at small angles, s", roll.natural_period, math.sqrt(scale)),
        ("linear damping, share of critical, %", roll.damping_ratio.scaled(100.0), 1.0),
        ("metacentric height GM, m", roll.metacentric_height, scale),
        ("radius of gyration with added inertia, m", roll.gyradius, scale),
    ]
    has_scale = scale != 1.0
    header = ("Quantity", "estimate", "95 % from", "to", *(("at full scale",) if has_scale else ()))
    return plain_table(
        header,
        [_quantity_row(name, value, factor, has_scale=has_scale) for name, value, factor in rows if value is not None],
    )


def _quantity_row(name: str, value: IntervalEstimate, factor: float, *, has_scale: bool) -> tuple[str, ...]:
    """Digits by the width of the interval; a value taken as exact has no interval to show."""
    error = 0.5 * (value.upper - value.lower)
    text, full = estimate_text(value.value, error, value.lower, value.upper), value.scaled(factor)
    bounds = (text.lower, text.upper) if error > 0.0 else (DASH, DASH)
    cells = (name, text.value, *bounds)
    return (*cells, estimate_text(full.value, factor * error, full.lower, full.upper).value) if has_scale else cells


def _swings(roll: RollCharacteristics) -> Section:
    """Period and damping of swings of some amplitudes."""
    places = np.linspace(0, len(roll.amplitude) - 1, _AMPLITUDES + 1).round().astype(int)[1:]
    table = table_of(
        places,
        number("Amplitude", lambda i: fixed(math.degrees(roll.amplitude[i]), 1), "deg"),
        number("period", lambda i: significant(roll.period[i], 4), "s"),
        number("equivalent damping", lambda i: significant(roll.damping[i], 3), "1/s"),
        number("95 % from", lambda i: significant(roll.damping_lower[i], 3)),
        number("to", lambda i: significant(roll.damping_upper[i], 3)),
        number("share of critical", lambda i: _percent_of_critical(roll, i), "%"),
    )
    note = (
        "Equivalent: the linear damping that takes as much energy in a swing, b₁ + 8/(3π) ω a b₂ + ¾ ω² a² b₃ (Himeno "
        "1981; ITTC 7.5-02-07-04.5)."
    )
    return Section("Swings of some amplitudes", table=table, note=note)


def _percent_of_critical(roll: RollCharacteristics, place: int) -> str:
    return significant(100.0 * share_of_critical(roll.damping[place], roll.period[place]), 2)


def share_of_critical(damping: float, period: float) -> float:
    """Return the equivalent damping b_e [1/s] of swings of a period T [s] over the critical, b_e / (2 w)."""
    return damping * period / (4.0 * math.pi)


def _picture(roll: RollCharacteristics) -> Picture:
    """Damping and period over amplitude, or the spectrum of roll."""
    if roll.spectrum:
        caption = "The sea's own spectrum, of one peak, is estimated with natural period and damping."
        return Picture(partial(_spectrum, roll), caption)
    caption = "Equivalent linear damping and period over the amplitude of a swing, the model with its 95 % band."
    if roll.swings:
        caption += " Dots: each recorded swing on its own, with damping 2 ln(aᵢ / aᵢ₊₂) / T, independent of the model."
    return Picture(lambda: svg(roll_damping_chart(roll)), caption)


def _spectrum(roll: RollCharacteristics) -> str:
    """Recorded and expected density of roll."""
    omega, recorded, expected = (np.array(column) for column in zip(*roll.spectrum, strict=True))
    lines = (
        Curve("recorded, smoothed", omega, _DEGREES**2 * recorded),
        Curve("expected", omega, _DEGREES**2 * expected),
    )
    return svg(study_chart(Figure("Spectrum of roll", "frequency, rad/s", "deg\u00b2 s/rad", lines, "")))
