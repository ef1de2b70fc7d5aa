"""Runs that are copies of one another: a run counts once, however often it is in the files."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import Record


def copies(records: Sequence[Record]) -> dict[int, int]:
    """Return the index of each record that repeats an earlier one, sample by sample -> the index of that one.

    Times count from the first sample; the names of the records do not matter.
    """
    earlier: dict[tuple[object, ...], int] = {}
    repeated = {}
    for index, record in enumerate(records):
        first = earlier.setdefault(_content(record), index)
        if first != index:
            repeated[index] = first
    return repeated


def _content(record: Record) -> tuple[object, ...]:
    time = np.round((record.time - record.time[0]) / record.dt) if record.is_uniform else record.time
    channels = tuple((s, record[s].tobytes()) for s in sorted(record.channels))
    return (time.tobytes(), round(record.duration, _DECIMALS), channels)


_DECIMALS = 6  # of seconds, to which durations are compared; chosen
