"""Which points of several objectives no other point beats."""

import numpy as np
from numpy.typing import NDArray

from seatrial.optimise.solution import Array


def non_dominated(objectives: Array) -> NDArray[np.intp]:
    """Rows no other row is as small as in every objective and smaller in one, shape (k,), in order of the first one.

    `objectives` has the shape (n, m), each to be made small; a row with infinity or NaN takes no part, and of equal
    rows the first stands for all. Cost: the square of the answer's size at worst times n / k.
    """
    finite = np.flatnonzero(np.isfinite(objectives).all(axis=1))
    rows, first = np.unique(objectives[finite], axis=0, return_index=True)
    left, kept = np.arange(len(rows)), []
    while left.size:
        kept.append(left[0])
        left = left[(rows[left] < rows[left[0]]).any(axis=1)]
    return finite[first[np.array(kept, dtype=np.intp)]]
