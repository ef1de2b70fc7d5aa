"""Which points of several objectives no other point beats."""

import math
from bisect import bisect_left, bisect_right

import numpy as np
from numpy.typing import NDArray

from seatrial.optimise.solution import Array

_SWEPT = 3


def non_dominated(objectives: Array) -> NDArray[np.intp]:
    """Rows no other row is as small as in every objective and smaller in one, shape (k,), in order of the first one.

    `objectives` has the shape (n, m), each to be made small; a row with infinity or NaN takes no part, and of equal
    rows the first stands for all. Up to three objectives cost n log n, more cost n k.
    """
    finite = np.flatnonzero(np.isfinite(objectives).all(axis=1))
    rows, first = np.unique(objectives[finite], axis=0, return_index=True)
    kept = _swept(rows) if rows.shape[1] <= _SWEPT else _sifted(rows)
    return finite[first[np.array(kept, dtype=np.intp)]]


def _swept(rows: Array) -> list[int]:
    """Of rows (n, m <= 3) in rising order: Kung, Luccio & Preparata 1975.

    A row is beaten if one before it has neither a larger second nor a larger third number; those that matter form a
    staircase, second numbers rising and third ones falling.
    """
    padded = np.zeros((len(rows), _SWEPT))
    padded[:, : rows.shape[1]] = rows
    seconds, thirds, kept = [-math.inf], [math.inf], []
    for i, (second, third) in enumerate(padded[:, 1:].tolist()):
        if thirds[bisect_right(seconds, second) - 1] <= third:
            continue
        kept.append(i)
        start = stop = bisect_left(seconds, second)
        while stop < len(thirds) and thirds[stop] >= third:
            stop += 1
        seconds[start:stop], thirds[start:stop] = [second], [third]
    return kept


def _sifted(rows: Array) -> list[int]:
    """Of rows (n, m) in rising order: each that is left beats what it can."""
    left, kept = np.arange(len(rows)), []
    while left.size:
        kept.append(int(left[0]))
        left = left[(rows[left] < rows[left[0]]).any(axis=1)]
    return kept
