"""Readings that stand for none, such as -999: one value far outside all others, again and again."""

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.data.check.repair import INPUT_CHANNELS

# ranges of the other values by which such a value lies outside them, how often it occurs at least, and how many
# different values the others have at least (a switch has two); chosen
FAR_RANGES, FEWEST_TIMES, FEWEST_VALUES = 5.0, 2, 10


def without_sentinels(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return the record with readings that stand for none made empty, and a finding for each channel that has such.

    Judged by behaviour, whatever the unit: commands are left alone.
    """
    findings = []
    for symbol in [s for s in record.channels if s not in INPUT_CHANNELS]:
        values = record[symbol]
        sentinel = sentinel_value(values)
        if sentinel is None:
            continue
        rows = values == sentinel
        channel = record.channel(symbol)
        record = record.with_channel(
            symbol, channel.with_values(np.where(rows, np.nan, values)), f"{rows.sum()} readings of {symbol} made empty"
        )
        text = f"record '{record.name}', channel '{symbol}': {rows.sum()} readings of {sentinel:.6g} {channel.unit} "
        text += "stand for none; they count as empty"
        rest = values[~rows & np.isfinite(values)]
        evidence = f"all others lie between {rest.min():.4g} and {rest.max():.4g}"
        findings.append(Finding(Severity.WARNING, "no-reading", text, evidence, "no action needed for a few"))
    return record, tuple(findings)


def sentinel_value(values: Array) -> float | None:
    """Return the one value, lowest or highest, that recurs far outside the range of all others; None: there is none."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return None
    for extreme in (float(finite.min()), float(finite.max())):
        rest = finite[finite != extreme]
        if finite.size - rest.size < FEWEST_TIMES or rest.size == 0:
            continue
        low, high = float(rest.min()), float(rest.max())
        distance = max(low - extreme, extreme - high)
        if distance > FAR_RANGES * (high - low) and np.unique(rest).size >= FEWEST_VALUES:
            return extreme
    return None
