"""What a snapshot says, in the words and digits people read: one text for the terminal and for the page."""

import math
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from seatrial.results.online import Change, Counts, Phase, Snapshot
from seatrial.values import NOTATION, Array, display

# two-sided 95 % of a normal distribution
NORMAL_95 = 1.96
MINUS, DASH = "\u2212", "\u2013"
BARS = "▁▂▃▄▅▆▇█"
NARROWER, WIDER = 0.9, 1.1
FIRST_DATE = 1e8
LONGEST = 300
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PHASES = {
    Phase.WAITING: "too little has been seen yet",
    Phase.WINDOW: "fit over everything seen, re-linearised as it grows",
    Phase.RECURSIVE: "filter that carries the fit's information on, sample by sample",
}
_TROUBLES = {
    "late": "late", "repeated": "repeated", "not_finite": "not a number", "missing": "missing", "jumps": "clock jumps",
    "garbled": "garbled", "checksum": "wrong checksum", "dropped": "dropped", "truncated": "file truncated",
}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One coefficient as text: value and 95 % interval with the same decimals, in `unit`, which names 10^`power`.

    share: standard error in per cent of the value; is_told: False where the data so far do not tell it.
    """

    name: str
    value: str
    half: str
    lower: str
    upper: str
    unit: str
    power: int
    share: str
    is_told: bool


def rows(snapshot: Snapshot) -> list[Row]:
    """The coefficients in the model's order; angles in degrees."""
    untold = set(snapshot.untold)
    told = zip(snapshot.names, snapshot.units, snapshot.value, snapshot.standard_error, strict=True)
    return [_row(name, unit, float(value), float(error), name not in untold) for name, unit, value, error in told]


def noises(snapshot: Snapshot) -> list[tuple[str, str, str]]:
    """Channel, rms of measured minus model, unit; angles in degrees."""
    shown = []
    for channel, rms in snapshot.noise.items():
        factor, unit = display(channel_unit(channel))
        shown.append((clean(channel), significant(factor * rms, 3), "" if unit == "1" else unit))
    return shown


def channel_unit(channel: str) -> str:
    """The channel's SI unit, 1 where the notation does not know it."""
    return NOTATION[channel].unit if channel in NOTATION else "1"


def troubles(counts: Counts) -> list[tuple[str, int]]:
    """What went wrong with samples, and how often; all of them, in one order."""
    return [(words, getattr(counts, key)) for key, words in _TROUBLES.items()]


def phase(which: Phase) -> str:
    """What the phase means."""
    return _PHASES[which]


def change(told: Change | None) -> str:
    """The change that was told, in a sentence; empty if none was."""
    if told is None or not told.is_told:
        return ""
    since, freedom = moment(told.since), f"{counted(told.freedom, 'degree')} of freedom"
    return (
        f"Since {since} the data tell other coefficients than before, {clean(told.most)} most of all "
        f"(chi-squared {significant(told.statistic, 3)} of {freedom}, p {significant(told.p, 2)})."
    )


def moment(time: float) -> str:
    """A moment of the stream's clock: seconds, or a date where they count from 1970."""
    if not math.isfinite(time):
        return DASH
    if FIRST_DATE <= time < 100 * FIRST_DATE:
        return datetime.fromtimestamp(time, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    return f"{fixed(time, 1)} s"


def duration(seconds: float) -> str:
    """Seconds, minutes and seconds, hours and minutes, days and hours."""
    if seconds < 120:
        return f"{fixed(seconds, 1)} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    hours, minutes = divmod(minutes, 60)
    if hours < 48:
        return f"{hours} h {minutes:02d} min"
    days, hours = divmod(hours, 24)
    return f"{days} d {hours:02d} h"


def clean(text: str, longest: int = LONGEST) -> str:
    """Text without control characters (a sentence from a socket may carry some), cut where it is long."""
    shown = "".join("·" if unicodedata.category(c).startswith("C") else c for c in text[: longest + 1])
    return shown if len(shown) <= longest else shown[: longest - 1] + "…"


def sparkline(values: Array, half: float, width: int = 12) -> str:
    """The course of a value as bars, newest last; a move that is small beside its interval looks flat.

    values: (n,) over the last minutes; half: half of the interval now, sets the least height shown.
    """
    known = values[np.isfinite(values)]
    if len(known) < 2:
        return ""
    picked = known[np.linspace(0, len(known) - 1, min(width, len(known))).round().astype(int)]
    low, high = float(picked.min()), float(picked.max())
    least = 2.0 * half if math.isfinite(half) else 0.0
    reach = max(high - low, least)
    if reach <= 0.0:
        return BARS[3] * len(picked)
    bottom = 0.5 * (low + high) - 0.5 * reach
    places = np.clip((picked - bottom) / reach * len(BARS), 0, len(BARS) - 1).astype(int)
    return "".join(BARS[k] for k in places)


def arrow(errors: Array) -> str:
    """Whether the interval became narrower (↘), wider (↗) or stayed (→) over the last minutes.

    errors: (n,) standard errors, newest last.
    """
    known = errors[np.isfinite(errors) & (errors > 0)]
    if len(known) < 2:
        return ""
    ratio = float(known[-1] / known[0])
    return "↘" if ratio < NARROWER else "↗" if ratio > WIDER else "→"


def fixed(value: float, decimals: int) -> str:
    """A number with so many decimals and a true minus sign; a dash where there is none."""
    if not math.isfinite(value):
        return DASH
    nearest = round(value, decimals) + 0.0
    return (MINUS if nearest < 0 else "") + f"{abs(nearest):.{max(decimals, 0)}f}"


def significant(value: float, digits: int) -> str:
    """A number with so many significant digits; a power of ten where it is long."""
    if not math.isfinite(value) or value == 0.0:
        return "0" if value == 0.0 else DASH
    power = _power(value, digits)
    if 1e-4 <= abs(value) < 1e7:
        return fixed(value, digits - 1 - power)
    return f"{fixed(value / 10.0**power, digits - 1)} ×10{str(power).translate(_SUPERSCRIPTS)}"


def counted(number: int, noun: str) -> str:
    """1 run, 2 runs."""
    return f"{number} {noun}{'s' * (number != 1)}"


def listed(items: Sequence[str], most: int = 8) -> str:
    """a, b and c; beyond `most`: a, b and 5 more."""
    if len(items) > most:
        return f"{', '.join(items[: most - 1])} and {len(items) - most + 1} more"
    return " and ".join([", ".join(items[:-1]), items[-1]]) if len(items) > 1 else "".join(items)


def _row(name: str, unit: str, value: float, error: float, is_told: bool) -> Row:
    factor, shown = display(unit)
    value, half = factor * value, NORMAL_95 * factor * error
    shown = "" if shown == "1" else clean(shown).replace("^2", "²").replace("^3", "³")
    share = _percent(_share(value, factor * error))
    if not math.isfinite(value) or not math.isfinite(half) or half <= 0.0:
        return Row(clean(name), significant(value, 4), DASH, DASH, DASH, shown, 0, share, is_told)
    largest = max(abs(value), half)
    power = 0 if 1e-2 <= largest < 1e5 else _power(largest, 2)
    scale = 10.0**power
    # no more than seven digits of the largest: a value known to a millionth is known
    decimals = min(1 - _power(half / scale, 2), 6 - _power(largest / scale, 2))
    texts = [fixed(x / scale, decimals) for x in (value, half, value - half, value + half)]
    unit = f"10{str(power).translate(_SUPERSCRIPTS)} {shown}".strip() if power else shown
    return Row(clean(name), texts[0], texts[1], texts[2], texts[3], unit, power, share, is_told)


def _share(value: float, error: float) -> float:
    return error / abs(value) if value != 0.0 and math.isfinite(value) and math.isfinite(error) else math.inf


def _percent(share: float) -> str:
    if not math.isfinite(share):
        return DASH
    return "> 999" if share > 9.99 else significant(100.0 * share, 2)


def _power(value: float, digits: int) -> int:
    """Decimal exponent after rounding to so many digits."""
    return int(f"{abs(value):.{digits - 1}e}".partition("e")[2])
