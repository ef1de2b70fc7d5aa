"""Values that stand for no reading, such as -999: one far outside all others, again and again."""

import numpy as np

from seatrial.core.values.arrays import Array

EMPTIED = "count as empty"
"""What a step of the provenance says of such readings; the checks repeat the sentence."""
# ranges of the other values by which such a value lies outside them, how often it occurs at least, and how many
# different values the others have at least (a switch has two); chosen
FAR_RANGES, FEWEST_TIMES, FEWEST_VALUES = 5.0, 2, 10


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
