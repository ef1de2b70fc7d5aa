"""When a logger received each sentence, as it wrote before it: for those that have no time of their own."""

import math
import re
from datetime import UTC, datetime

import numpy as np

from seatrial.core.values import Array

# date and time with parts of a second; seconds or milliseconds since 1970
_ISO = re.compile(rb"(\d{4}-\d\d-\d\d)[T ](\d\d:\d\d:\d\d[.,]\d{1,6})")
_UNIX = re.compile(rb"(?<!\d)(1\d{9}\.\d{1,9})(?!\d)")
_UNIX_MS = re.compile(rb"(?<!\d)(1\d{12})(?!\d)")
_MS = 1e-3  # s, of a millisecond
_LEAST_SHARE = 0.99  # of the sentences that have a receipt, from which on it is used; chosen


def receipt_time(line: bytes) -> float:
    """Return the time before the ``$`` of a line [s since 1970, zone left out]; NaN without one to parts of a s."""
    head = line[: max(line.rfind(b"$"), line.rfind(b"!"), 0)]
    if match := _ISO.search(head):
        text = b"T".join(match.groups()).replace(b",", b".").decode()
        return datetime.fromisoformat(text).replace(tzinfo=UTC).timestamp()
    if match := _UNIX.search(head):
        return float(match[1])
    return _MS * int(match[1]) if (match := _UNIX_MS.search(head)) else math.nan


def on_the_clock(receipts: Array, stamps: Array) -> Array | None:
    """Return the times of sentences by their receipt, moved to the clock of those that have a time of their own.

    Args:
        receipts: (n,) s, NaN where there is none; stamps: (n,) s, of sentences with a time of their own, NaN else.

    The logger's clock and the delay of the line are the median difference. None: too few receipts, or they run back.
    """
    differences = receipts - stamps
    if np.mean(np.isfinite(receipts)) < _LEAST_SHARE or not np.isfinite(differences).any():
        return None
    rows = np.arange(len(receipts))
    known = np.isfinite(receipts)
    times = np.interp(rows, rows[known], receipts[known]) - float(np.nanmedian(differences))
    return None if np.any(np.diff(times) < 0.0) else times
