"""How much of a run its repair leaves: a repair never destroys quietly."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import Finding, Record, Severity
from seatrial.data.check.run_clock import moment

# share of the rows of a run that a repair may drop as a warning; the project's rule
LARGEST_DROPPED_SHARE = 0.05


def dropped_rows_findings(record: Record, parts: Sequence[Record]) -> tuple[Finding, ...]:
    """An error where the repair leaves less than 95 % of the rows that hold a value.

    record: as it was read; parts: what the repair keeps.
    """
    filled = ~np.all([np.isnan(c.values) for c in record.channels.values()], axis=0) & np.isfinite(record.time)
    rows, kept = int(np.sum(filled)), 0
    for part in parts:
        half = 0.5 * part.dt if len(part) > 1 else 0.0
        inside = (record.time >= part.time[0] - half) & (record.time <= part.time[-1] + half) & filled
        kept += min(int(np.sum(inside)), len(part))
    complete = max(parts, key=len)
    if rows == 0 or kept >= (1.0 - LARGEST_DROPPED_SHARE) * rows:
        return ()
    return (
        Finding(
            Severity.ERROR,
            "rows-dropped",
            f"record '{record.name}': the repair drops {1.0 - kept / rows:.0%} of its rows",
            f"{kept} of {rows} rows remain, {moment(complete.time[0], complete.time[-1])}",
            _advice(record),
        ),
    )


def _advice(record: Record) -> str:
    """The emptiest channel to leave out."""
    empty = {symbol: int(np.sum(np.isnan(channel.values))) for symbol, channel in record.channels.items()}
    emptiest = max(empty, key=lambda symbol: empty[symbol])
    if empty[emptiest]:
        return f"remove channels.{emptiest}, which is empty in {empty[emptiest]} rows, from the trial file"
    return "check the unit of time and the time column; the stamps are too uneven to keep the rows"
