"""A snapshot in words and rounded numbers: one text for the terminal and for the page."""

import math
from dataclasses import dataclass
from datetime import UTC, datetime

from seatrial.core.results.online import CoefficientChange, EstimatorPhase, SampleCounts, Snapshot
from seatrial.core.text.numbers import DASH, exponent, fixed, percent, raised, significant
from seatrial.core.text.words import counted, printable
from seatrial.core.values import display_unit
from seatrial.core.values.notation import channel_unit, unit_text

# quantile of the standard normal distribution for 95 %, two-sided
NORMAL_95 = 1.96
# s: a clock that shows more counts from 1970; chosen: three years later, longer than any stream from its own start
FIRST_UNIX_TIME = 1e8
_PHASE_MEANINGS = {
    EstimatorPhase.WAITING: "too few samples for an estimate yet",
    EstimatorPhase.WINDOW: "fit over all samples, repeated as they grow",
    EstimatorPhase.RECURSIVE: "filter that continues the fit, sample by sample",
}
_NOTHING_FREE = "every coefficient is fixed: nothing to estimate"
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


def phase_meaning(snapshot: Snapshot) -> str:
    """Return what the phase means, in words."""
    return _PHASE_MEANINGS[snapshot.phase] if snapshot.names else _NOTHING_FREE


def estimate_rows(snapshot: Snapshot) -> list[EstimateRow]:
    """Return the coefficients in the model's order; angles in degrees."""
    unidentified = set(snapshot.unidentified)
    columns = zip(snapshot.names, snapshot.units, snapshot.value, snapshot.standard_error, strict=True)
    return [
        _estimate_row(name, unit, float(value), float(error), name not in unidentified)
        for name, unit, value, error in columns
    ]


def residual_rms(snapshot: Snapshot) -> list[tuple[str, str, str]]:
    """Return channel, rms of measured minus simulated, unit; angles in degrees."""
    units = {channel: channel_unit(channel) for channel in snapshot.noise}
    return [(printable(channel), significant(display_unit(units[channel])[0] * rms, 3), unit_text(units[channel]))
            for channel, rms in snapshot.noise.items()]  # fmt: skip


def fault_counts(counts: SampleCounts) -> list[tuple[str, int]]:
    """Return each kind of fault in words and its count, always in the same order."""
    return [(words, getattr(counts, key)) for key, words in _FAULT_NAMES.items()]


def faults_text(counts: SampleCounts) -> str:
    """Return the faults that occurred: ``3 late, 1 garbled``; empty for none."""
    return ", ".join(f"{count} {words}" for words, count in fault_counts(counts) if count)


def change_sentence(change: CoefficientChange | None) -> str:
    """Return a significant change as a sentence; empty if there is none."""
    if change is None or not change.is_significant:
        return ""
    since, freedom = time_text(change.since), f"{counted(change.degrees_of_freedom, 'degree')} of freedom"
    return (
        f"The coefficients have changed since {since}, {printable(change.most_changed)} most of all "
        f"(chi-squared {significant(change.statistic, 3)} of {freedom}, p {significant(change.p, 2)})."
    )


def time_text(time: float) -> str:
    """Return a time of the stream's clock: seconds, or a date where they count from 1970."""
    if not math.isfinite(time):
        return DASH
    if FIRST_UNIX_TIME <= time < 100 * FIRST_UNIX_TIME:
        return datetime.fromtimestamp(time, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    return f"{fixed(time, 1)} s"


def _estimate_row(name: str, unit: str, value: float, error: float, is_identified: bool) -> EstimateRow:
    factor, si_text = display_unit(unit)[0], printable(unit_text(unit))
    value, error = factor * value, factor * error
    half, is_finite = NORMAL_95 * error, math.isfinite(value) and math.isfinite(error)
    share = percent(error / abs(value) if value != 0.0 and is_finite else math.inf)
    if not is_finite or half <= 0.0:
        return EstimateRow(printable(name), significant(value, 4), DASH, DASH, DASH, si_text, 0, share, is_identified)
    largest = max(abs(value), half)
    # sizes outside this range are written with a power of ten; chosen, as in `significant`
    power = 0 if 1e-2 <= largest < 1e5 else exponent(largest, 2)
    scale = 10.0**power
    # no more than seven digits of the largest: a value known to a millionth is known
    decimals = min(1 - exponent(half / scale, 2), 6 - exponent(largest / scale, 2))
    text, width, *ends = (fixed(x / scale, decimals) for x in (value, half, value - half, value + half))
    unit = f"10{raised(power)} {si_text}".strip() if power else si_text
    return EstimateRow(printable(name), text, width, ends[0], ends[1], unit, power, share, is_identified)
