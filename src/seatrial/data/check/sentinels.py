"""Readings that stand for none, such as -999: one value far outside all others, again and again."""

import numpy as np

from seatrial.core.values import Finding, Record, Severity
from seatrial.core.values.no_reading import EMPTIED, sentinel_value
from seatrial.data.check.repair import INPUT_CHANNELS
from seatrial.data.check.run_clock import moment

_ADVICE = "no action needed for a few"


def without_sentinels(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return the record with readings that stand for none made empty, and a finding for each channel that has such.

    Judged by behaviour, whatever the unit: commands are left alone. What was emptied as the log was read is found too.
    """
    emptied = [step for step in record.provenance.steps if step.endswith(EMPTIED)]
    findings = [
        Finding(Severity.WARNING, "no-reading", f"record '{record.name}', {step}", "", _ADVICE) for step in emptied
    ]
    for symbol in [s for s in record.channels if s not in INPUT_CHANNELS]:
        values = record[symbol]
        sentinel = sentinel_value(values, record.channel(symbol).unit)
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
        times = record.time[rows]
        evidence = f"the first and the last at {moment(times[0], times[-1])}; all others lie between "
        evidence += f"{rest.min():.4g} and {rest.max():.4g}"
        findings.append(Finding(Severity.WARNING, "no-reading", text, evidence, _ADVICE))
    return record, tuple(findings)
