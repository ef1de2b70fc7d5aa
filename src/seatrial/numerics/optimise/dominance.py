"""Which points of several objectives no other point beats, and how much they beat together."""

import numpy as np
from numpy.typing import NDArray

from seatrial.numerics.optimise.solution import Array


def non_dominated(objectives: Array) -> NDArray[np.intp]:
    """Return rows no other row is as small as in every objective and smaller in one, shape (k,), in rising order.

    `objectives` has the shape (n, m), each to be made small; a row with infinity or NaN takes no part, and of equal
    rows the first stands for all.
    """
    from moocore import is_nondominated

    finite = np.flatnonzero(np.isfinite(objectives).all(axis=1))
    if not finite.size:
        return finite
    kept = finite[np.asarray(is_nondominated(objectives[finite], keep_weakly=False), dtype=bool)]
    return kept[np.lexsort(objectives[kept].T[::-1])]


def hypervolume(objectives: Array, reference: Array) -> float:
    """Return the volume that the points (n, m) dominate within the reference point (m,)."""
    from moocore import hypervolume as volume

    return float(volume(objectives, ref=reference))
