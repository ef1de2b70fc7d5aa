"""Boxes about a truth, and truths near published values."""

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box

# least and largest share of a box's width between its lower bound and the truth; chosen
_LOWEST_PLACE, _HIGHEST_PLACE = 0.2, 0.8


def centred_box(truth: Array, half_width: float) -> Box:
    """Return the box of the truth +- a share of it: the truth in the middle."""
    ends = np.stack([truth * (1.0 - half_width), truth * (1.0 + half_width)])
    return Box(ends.min(axis=0), ends.max(axis=0))


def off_centre_box(truth: Array, half_width: float, rng: np.random.Generator) -> Box:
    """As wide, the truth anywhere between a fifth and four fifths of it."""
    below = 2.0 * half_width * rng.uniform(_LOWEST_PLACE, _HIGHEST_PLACE, len(truth))
    ends = np.stack([truth * (1.0 - below), truth * (1.0 + 2.0 * half_width - below)])
    return Box(ends.min(axis=0), ends.max(axis=0))


def scaled_values(published: Array, half_range: float, rng: np.random.Generator) -> Array:
    """Return values each scaled by a factor of its own within 1 +- half_range, (d,)."""
    return published * rng.uniform(1.0 - half_range, 1.0 + half_range, len(published))
