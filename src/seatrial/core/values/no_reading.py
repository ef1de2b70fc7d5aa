"""Values that stand for no reading, such as -999: one far outside all others, again and again."""

import math

import numpy as np

from seatrial.core.values.arrays import Array

EMPTIED = "count as empty"
"""What a step of the provenance says of such readings; the checks repeat the sentence."""
# ranges of the other values by which such a value lies outside them, how often it occurs at least, and how many
# different values the others have at least (a switch has two); chosen
FAR_RANGES, FEWEST_TIMES, FEWEST_VALUES = 5.0, 2, 10
_TURN_SLACK = 1e-3  # rad by which rounded angles may span more than a turn: half of a tenth of a degree


def sentinel_value(values: Array, unit: str = "") -> float | None:
    """Return the one value, lowest or highest, that recurs far outside the range of all others; None: there is none.

    unit: of angles, rad, for which the way round counts: 0 lies next to 359 degrees.
    """
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return None
    for extreme in (float(finite.min()), float(finite.max())):
        rest = finite[finite != extreme]
        if finite.size - rest.size < FEWEST_TIMES or rest.size == 0:
            continue
        low, high = float(rest.min()), float(rest.max())
        distance = max(low - extreme, extreme - high)
        round_about = math.tau - (max(high, extreme) - min(low, extreme))
        if unit == "rad" and round_about > -_TURN_SLACK:
            distance = min(distance, round_about)
        if distance > FAR_RANGES * (high - low) and np.unique(rest).size >= FEWEST_VALUES:
            return extreme
    return None
