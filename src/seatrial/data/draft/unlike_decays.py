"""Roll decays that differ: in how they die out, of another speed or loading, or in the heel about which they roll."""

import math
from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Record
from seatrial.data.check.roll_release import half_swings
from seatrial.data.draft.motion_stretches import half_swing_angles

_UNLIKE = (
    1.5  # of the decrement of the next decay, from which on two groups of decays differ; chosen: scatter is a tenth
)
_SMALLEST_SHARE = 0.25  # of the first swing, down to which swings count: below, wind and noise swing along; chosen
_FEWEST = 4  # swings that give a decrement; chosen
_NAMES_SHOWN = 4  # ours
_CERTAIN = 4.0  # standard errors by which heels differ; chosen: they are correlated from swing to swing
_LEAST_HEEL = math.radians(0.2)  # rad, difference of heels from which on it matters; chosen: 2 % of a release of 10 deg


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


def heels_apart(decays: Mapping[str, Record]) -> tuple[float, float] | None:
    """Return least and largest heel about which decays roll [rad], where they differ; None: one angle serves all.

    decays: as above.
    """
    rests = [found for record in decays.values() if (found := _rest(record["phi"])) is not None]
    if len(rests) < 2:
        return None
    (low, low_error), (high, high_error) = min(rests), max(rests)
    limit = max(_CERTAIN * math.hypot(low_error, high_error), _LEAST_HEEL)
    return (low, high) if high - low > limit else None


def _rest(phi: Array) -> tuple[float, float] | None:
    """The heel between the swings' extremes [rad], and its standard error; None of too few swings.

    A quarter of two extremes to one side and half of the one between lie at the rest but for (1 - rho)^2 / 4 of the
    swing, rho the share that is left from one to the next.
    """
    rest = float(np.median(phi))
    tops = np.array([_extreme(phi[half_swing.first : half_swing.stop], rest) for half_swing in half_swings(phi - rest)])
    if len(tops) < _FEWEST + 2:
        return None
    middles = 0.25 * (tops[:-2] + 2.0 * tops[1:-1] + tops[2:])
    return float(np.median(middles)), float(np.std(middles)) / math.sqrt(len(middles))


def _extreme(swing: Array, rest: float) -> float:
    return float(swing[np.argmax(np.abs(swing - rest))])


def _decrement(phi: Array) -> float | None:
    """The mean decrease of the logarithm of the angle from swing to swing; None of too few swings."""
    angles = half_swing_angles(phi - float(np.median(phi)))
    large = angles[angles > _SMALLEST_SHARE * angles.max(initial=0.0)]
    if len(large) < _FEWEST:
        return None
    return -float(np.polyfit(np.arange(len(large)), np.log(large), 1)[0])
