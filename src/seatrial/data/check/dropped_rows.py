"""How much of a run its repair leaves: a repair never destroys quietly."""

import numpy as np

from seatrial.core.values import Finding, Record, Severity
from seatrial.data.check.repair import complete_segments
from seatrial.data.check.run_clock import moment

# share of the rows of a run that a repair may drop as a warning; the project's rule
LARGEST_DROPPED_SHARE = 0.05
# s of a stretch worth a part, and how many parts are proposed; chosen
_SHORTEST_PART_S, _MOST_PARTS = 10.0, 4
_MOST_OF_A_RUN = 0.5  # share of the rows that parts must keep to be proposed; chosen


def dropped_rows_findings(record: Record, even: Record, complete: Record) -> tuple[Finding, ...]:
    """An error where the repair leaves less than 95 % of the rows that hold a value.

    record: as it was read; even: on its even base; complete: what the repair keeps.
    """
    filled = ~np.all([np.isnan(c.values) for c in record.channels.values()], axis=0) & np.isfinite(record.time)
    rows = int(np.sum(filled))
    half = 0.5 * complete.dt if len(complete) > 1 else 0.0
    inside = (record.time >= complete.time[0] - half) & (record.time <= complete.time[-1] + half) & filled
    kept = min(int(np.sum(inside)), len(complete))
    if rows == 0 or kept >= (1.0 - LARGEST_DROPPED_SHARE) * rows:
        return ()
    return (
        Finding(
            Severity.ERROR,
            "rows-dropped",
            f"record '{record.name}': the repair drops {1.0 - kept / rows:.0%} of its rows",
            f"{kept} of {rows} rows remain, {moment(complete.time[0], complete.time[-1])}",
            _advice(record, even),
        ),
    )


def _advice(record: Record, even: Record) -> str:
    """The complete stretches as parts where they are most of the run; else the emptiest channel to leave out."""
    start = float(record.time[np.isfinite(record.time)][0])
    stretches = [one for one in complete_segments(even) if one.duration >= _SHORTEST_PART_S]
    if sum(map(len, stretches)) > _MOST_OF_A_RUN * len(even):
        longest = sorted(stretches, key=len)[::-1][:_MOST_PARTS]
        ends = [(f"{one.time[0] - start:.6g} s", f"{one.time[-1] - start:.6g} s") for one in longest]
        parts = ", ".join(
            f'{{ name = "{record.name}-{k}", from = "{first}", to = "{last}" }}'
            for k, (first, last) in enumerate(ends, start=1)
        )
        return f"cut the run at its holes: parts = [{parts}]"
    empty = {symbol: int(np.sum(np.isnan(channel.values))) for symbol, channel in record.channels.items()}
    emptiest = max(empty, key=lambda symbol: empty[symbol])
    if empty[emptiest]:
        return f"remove channels.{emptiest}, which is empty in {empty[emptiest]} rows, from the trial file"
    return "check the unit of time and the time column; the stamps are too uneven to keep the rows"
