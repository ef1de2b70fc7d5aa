"""What a snapshot says, in the words and digits people read: one text for the terminal and for the page."""

import math
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from seatrial.core.results.online import CoefficientChange, EstimatorPhase, SampleCounts, Snapshot
from seatrial.core.text.screen_numbers import DASH, exponent, fixed, percent, significant, superscript
from seatrial.core.values import NOTATION, display_unit

# two-sided 95 % of a normal distribution
NORMAL_95 = 1.96
FIRST_UNIX_TIME = 1e8
MAX_TEXT_LENGTH = 300
_PHASE_MEANINGS = {
    EstimatorPhase.WAITING: "too little has been seen yet",
    EstimatorPhase.WINDOW: "fit over everything seen, re-linearised as it grows",
    EstimatorPhase.RECURSIVE: "filter that carries the fit's information on, sample by sample",
}
_FAULT_NAMES = {
    "late": "late", "repeated": "repeated", "not_finite": "not a number", "missing": "missing", "jumps": "clock jumps",
    "garbled": "garbled", "checksum": "wrong checksum", "dropped": "dropped", "truncated": "file truncated",
}  # fmt: skip


@dataclass(frozen=True)
class EstimateRow:
    """One coefficient as text: value and 95 % interval with the same decimals, in `unit`, which names 10^`power`.

    error_percent: standard error in per cent of the value; is_identified: False where the data do not determine it.
    """

    name: str
    value: str
    half_width: str
    lower: str
    upper: str
    unit: str
    power: int
    error_percent: str
    is_identified: bool


def estimate_rows(snapshot: Snapshot) -> list[EstimateRow]:
    """The coefficients in the model's order; angles in degrees."""
    untold = set(snapshot.unidentified)
    told = zip(snapshot.names, snapshot.units, snapshot.value, snapshot.standard_error, strict=True)
    return [
        _estimate_row(name, unit, float(value), float(error), name not in untold) for name, unit, value, error in told
    ]


def residual_rms(snapshot: Snapshot) -> list[tuple[str, str, str]]:
    """Channel, rms of measured minus model, unit; angles in degrees."""
    shown = []
    for channel, rms in snapshot.noise.items():
        factor, unit = display_unit(channel_unit(channel))
        shown.append((clean(channel), significant(factor * rms, 3), "" if unit == "1" else unit))
    return shown


def channel_unit(channel: str) -> str:
    """The channel's SI unit, 1 where the notation does not know it."""
    return NOTATION[channel].unit if channel in NOTATION else "1"


def fault_counts(counts: SampleCounts) -> list[tuple[str, int]]:
    """What went wrong with samples, and how often; all of them, in one order."""
    return [(words, getattr(counts, key)) for key, words in _FAULT_NAMES.items()]


def phase_meaning(phase: EstimatorPhase) -> str:
    """What the phase means."""
    return _PHASE_MEANINGS[phase]


def change_sentence(change: CoefficientChange | None) -> str:
    """The change that was told, in a sentence; empty if none was."""
    if change is None or not change.is_significant:
        return ""
    since, freedom = time_text(change.since), f"{counted(change.degrees_of_freedom, 'degree')} of freedom"
    return (
        f"Since {since} the data tell other coefficients than before, {clean(change.most_changed)} most of all "
        f"(chi-squared {significant(change.statistic, 3)} of {freedom}, p {significant(change.p, 2)})."
    )


def time_text(time: float) -> str:
    """A moment of the stream's clock: seconds, or a date where they count from 1970."""
    if not math.isfinite(time):
        return DASH
    if FIRST_UNIX_TIME <= time < 100 * FIRST_UNIX_TIME:
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


def clean(text: str, longest: int = MAX_TEXT_LENGTH) -> str:
    """Text without control characters (a sentence from a socket may carry some), cut where it is long."""
    shown = "".join("·" if unicodedata.category(c).startswith("C") else c for c in text[: longest + 1])
    return shown if len(shown) <= longest else shown[: longest - 1] + "…"


def counted(number: int, noun: str) -> str:
    """1 run, 2 runs."""
    return f"{number} {noun}{'s' * (number != 1)}"


def listed(items: Sequence[str], most: int = 8) -> str:
    """a, b and c; beyond `most`: a, b and 5 more."""
    if len(items) > most:
        return f"{', '.join(items[: most - 1])} and {len(items) - most + 1} more"
    return " and ".join([", ".join(items[:-1]), items[-1]]) if len(items) > 1 else "".join(items)


def _estimate_row(name: str, unit: str, value: float, error: float, is_identified: bool) -> EstimateRow:
    factor, shown = display_unit(unit)
    value, half = factor * value, NORMAL_95 * factor * error
    shown = "" if shown == "1" else clean(shown).replace("^2", "²").replace("^3", "³")
    share = percent(_relative_error(value, factor * error))
    if not math.isfinite(value) or not math.isfinite(half) or half <= 0.0:
        return EstimateRow(clean(name), significant(value, 4), DASH, DASH, DASH, shown, 0, share, is_identified)
    largest = max(abs(value), half)
    power = 0 if 1e-2 <= largest < 1e5 else exponent(largest, 2)
    scale = 10.0**power
    # no more than seven digits of the largest: a value known to a millionth is known
    decimals = min(1 - exponent(half / scale, 2), 6 - exponent(largest / scale, 2))
    texts = [fixed(x / scale, decimals) for x in (value, half, value - half, value + half)]
    unit = f"10{superscript(power)} {shown}".strip() if power else shown
    return EstimateRow(clean(name), texts[0], texts[1], texts[2], texts[3], unit, power, share, is_identified)


def _relative_error(value: float, error: float) -> float:
    return error / abs(value) if value != 0.0 and math.isfinite(value) and math.isfinite(error) else math.inf
