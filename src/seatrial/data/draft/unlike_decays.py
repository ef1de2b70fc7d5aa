"""Roll decays that die out at different rates: another speed or loading, which a trial of its own describes."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Record
from seatrial.data.draft.motion_stretches import half_swing_angles

_UNLIKE = (
    1.5  # of the decrement of the next decay, from which on two groups of decays differ; chosen: scatter is a tenth
)
_SMALLEST_SHARE = 0.25  # of the first swing, down to which swings count: below, wind and noise swing along; chosen
_FEWEST = 4  # swings that give a decrement; chosen
_NAMES_SHOWN = 4  # ours


def unlike_decays_text(decays: Mapping[str, Record]) -> str:
    """Return which decays die out faster than the others, and what to do; empty where all are alike.

    decays: records of roll decays from their releases, by name.
    """
    decrements = {name: found for name, record in decays.items() if (found := _decrement(record["phi"])) is not None}
    ordered = sorted(decrements, key=decrements.__getitem__)
    ratios = [decrements[b] / max(decrements[a], 1e-9) for a, b in pairwise(ordered)]  # never a division by zero
    if not ratios or max(ratios) < _UNLIKE:
        return ""
    cut = int(np.argmax(ratios)) + 1
    slow, fast = ordered[:cut], ordered[cut:]
    low, high = (float(np.median([decrements[name] for name in group])) for group in (slow, fast))
    names = enumeration(sorted(fast), _NAMES_SHOWN)
    verb = "dies" if len(fast) == 1 else "die"
    return (
        f"{names} {verb} out {high / low:.2g} times as fast as the others: if they were run at another speed or "
        "loading, draft each condition by itself, from its logs alone"
    )


def _decrement(phi: Array) -> float | None:
    """The mean decrease of the logarithm of the angle from swing to swing; None of too few swings."""
    angles = half_swing_angles(phi - float(np.median(phi)))
    large = angles[angles > _SMALLEST_SHARE * angles.max(initial=0.0)]
    if len(large) < _FEWEST:
        return None
    return -float(np.polyfit(np.arange(len(large)), np.log(large), 1)[0])
