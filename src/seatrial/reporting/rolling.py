"""The chapter on roll: what the coefficients mean, as tables and a figure."""

import math

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.curves import curves
from seatrial.core.figures.swings import swings
from seatrial.core.results import Curve, Figure, Rolling
from seatrial.core.results.rolling import Estimated
from seatrial.core.text.numbers import DASH, estimate, fixed, significant
from seatrial.reporting.sheets import Sheet

_SHOWN, _DEGREES = 5, 180.0 / math.pi


def sheets(known: Rolling, scale: float) -> list[Sheet]:
    """Derived quantities, at full scale too where the model is not (Froude's law), and swings of some amplitudes."""
    rows = [
        ("natural period at small angles, s", known.natural_period, math.sqrt(scale)),
        ("linear damping, share of critical, %", known.damping_ratio.times(100.0), 1.0),
        ("metacentric height GM, m", known.metacentric_height, scale),
        ("radius of gyration with added inertia, m", known.gyradius, scale),
    ]
    has_scale = scale != 1.0
    header = ("Quantity", "estimate", "95 % from", "to", *(("at full scale",) if has_scale else ()))
    made = tuple(_row(name, value, factor, has_scale=has_scale) for name, value, factor in rows if value is not None)
    note = f"Radius of gyration: {known.assumed}. The range of GM has the whole range of that radius in it."
    first = Sheet("What the coefficients mean", header, _numeric(header), made, note)
    return [first, _by_amplitude(known)] if known.amplitude else [first]


def _row(name: str, value: Estimated, factor: float, *, has_scale: bool) -> tuple[str, ...]:
    """Digits by the width of the interval; a value taken as exact has no interval to show."""
    error = 0.5 * (value.upper - value.lower)
    own, full = estimate(value.value, error, value.lower, value.upper), value.times(factor)
    bounds = (own.lower, own.upper) if error > 0.0 else (DASH, DASH)
    shown = (name, own.value, *bounds)
    return (*shown, estimate(full.value, factor * error, full.lower, full.upper).value) if has_scale else shown


def _numeric(header: tuple[str, ...]) -> tuple[bool, ...]:
    return (False, *(True for _ in header[1:]))


def _by_amplitude(known: Rolling) -> Sheet:
    places = np.linspace(0, len(known.amplitude) - 1, _SHOWN + 1).round().astype(int)[1:]
    rows = tuple(
        (
            fixed(math.degrees(known.amplitude[i]), 1),
            significant(known.period[i], 4),
            *(significant(b[i], 3) for b in (known.damping, known.damping_lower, known.damping_upper)),
            significant(100.0 * known.damping[i] * known.period[i] / (4.0 * math.pi), 2),
        )
        for i in places
    )
    header = ("Amplitude, deg", "period, s", "equivalent damping, 1/s", "95 % from", "to", "share of critical, %")
    note = (
        "Equivalent: the linear damping that takes as much energy in a swing, b₁ + 8/(3π) ω a b₂ + ¾ ω² a² b₃ (Himeno "
        "1981; ITTC 7.5-02-07-04.5)."
    )
    return Sheet("Swings of some amplitudes", header, (True, *_numeric(header)[1:]), rows, note)


def figures(known: Rolling) -> list[tuple[Markup, Figure]]:
    """Damping and period over amplitude."""
    said = "Equivalent linear damping and period over the amplitude of a swing, the model with its 95 % band."
    if known.swings:
        said += " Dots: each recorded swing by itself, its damping 2 ln(aᵢ / aᵢ₊₂) / T, without any model."
    if known.spectrum:
        return [_spectrum(known)]
    drawn = swings(known)
    return [(Markup(drawn), Figure("Damping and period", "", "", (), said))] if drawn else []


def _spectrum(known: Rolling) -> tuple[Markup, Figure]:
    """Recorded and expected density of roll."""
    omega, seen, expected = (np.array(column) for column in zip(*known.spectrum, strict=True))
    lines = (Curve("recorded, smoothed", omega, _DEGREES**2 * seen), Curve("expected", omega, _DEGREES**2 * expected))
    note = "The sea's own spectrum, of one peak, is estimated with natural period and damping."
    made = Figure("Spectrum of roll", "frequency, rad/s", "deg\u00b2 s/rad", lines, note)
    return Markup(curves(made)), made
