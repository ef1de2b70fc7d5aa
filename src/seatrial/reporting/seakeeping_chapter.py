"""The chapters of motions: roll with its damping, and motions in waves."""

import math
from functools import partial

import numpy as np

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Curve, Figure, RollCharacteristics, Seakeeping
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.text.numbers import DASH, estimate_text, fixed, significant
from seatrial.reporting.figures.response_charts import roll_damping_chart, study_chart
from seatrial.reporting.section import Level, Picture, Section, TextTable, number, plain_table, table_of, words

# The chapter on roll: what the coefficients mean, as tables and a figure.

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


# The chapter on waves: operators, spectra and statistics of the ship in its sea, as tables and figures.

# m; a shorter ship carries nobody who could be sick; chosen, below the smallest boats with a crew
LEAST_CREWED_LENGTH = 6.0
_DIGITS = 3  # significant; chosen


def seakeeping_section(seakeeping: Seakeeping | None, length: float) -> Section:
    """Return the chapter on the ship in its sea; empty where there is none.

    length: of the ship [m], 0 where it is unknown.
    """
    if seakeeping is None:
        return Section("")
    motions = (
        ("heave, m", seakeeping.heave_significant, seakeeping.zero_crossing_periods[0]),
        ("pitch, deg", seakeeping.pitch_significant, seakeeping.zero_crossing_periods[1]),
    )
    table = table_of(
        motions,
        words("Motion", lambda row: row[0]),
        number("significant amplitude", lambda row: significant(row[1], _DIGITS)),
        number("mean zero-crossing period", lambda row: significant(row[2], _DIGITS), "s"),
    )
    note = (
        f"{seakeeping.sea}; {seakeeping.speed:.3g} m/s, {seakeeping.heading:.0f}\u00b0 to the waves (180\u00b0: head)."
    )
    return Section(
        "Motions in waves",
        "waves",
        table=table,
        note=note,
        parts=(_along_ship(seakeeping, length), *_spectra(seakeeping)),
        level=Level.PAGE,
    )


def _along_ship(seakeeping: Seakeeping, length: float) -> Section:
    """Vertical motion along the ship, and who is sick of it."""
    is_crewed = not 0.0 < length < LEAST_CREWED_LENGTH
    table = table_of(
        seakeeping.points,
        words("Place", lambda p: p.place),
        number("forward", lambda p: significant(p.x, _DIGITS), "m"),
        number("significant", lambda p: significant(p.significant_amplitude, _DIGITS), "m"),
        number("acceleration rms", lambda p: significant(p.rms_acceleration, _DIGITS), "m/s\u00b2"),
        number("sick in two hours", lambda p: _percent(p.sickness_incidence) if is_crewed else "", "%"),
    )
    note = "Sickness by O'Hanlon & McCauley 1974." if is_crewed else ""
    return Section("Vertical motion along the ship", table=table, note=note)


def _percent(share: float) -> str:
    return significant(100.0 * share, _DIGITS)


def _spectra(seakeeping: Seakeeping) -> list[Section]:
    """Response amplitude operators, their phases, and spectra."""
    omega = np.array(seakeeping.omega)
    across = "wave frequency, rad/s"

    def section(title: str, label: str, caption: str, lines: dict[str, tuple[float, ...]]) -> Section:
        curves = tuple(Curve(name, omega, np.array(y)) for name, y in lines.items())
        figure = Figure(title, across, label, curves, caption)
        return Section(title, pictures=(Picture(lambda: svg(study_chart(figure)), caption),))

    pitch, sea = np.array(seakeeping.pitch_density), np.array(seakeeping.sea_density)
    share = float(np.max(sea) / max(np.max(pitch), 1e-300))  # above zero
    return [
        section(
            "Response amplitude operators",
            "per wave",
            "Heave per wave amplitude, pitch per wave slope. A hull "
            "that the wave carries has 1, in pitch the heading's cosine; constant damping keeps pitch from it.",
            {"heave": seakeeping.heave, "pitch / slope": seakeeping.pitch},
        ),
        section(
            "Phases",
            "degrees ahead of the crest",
            "At the ship's origin; pitch against the slope, bow down.",
            {"heave": seakeeping.heave_phase, "pitch": seakeeping.pitch_phase},
        ),
        section(
            "Spectra",
            "m\u00b2 s/rad",
            f"Over the wave frequency; pitch in deg\u00b2 s/rad times {share:.2g}.",
            {"sea": seakeeping.sea_density, "heave": seakeeping.heave_density, "pitch": tuple(share * pitch)},
        ),
    ]
