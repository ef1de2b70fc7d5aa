"""Boxes about a truth, and truths near published values."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.estimation.information.covariance import from_information
from seatrial.numerics.optimise import Box

# least and largest share of a box's width between its lower bound and the truth; chosen
_LOWEST_PLACE, _HIGHEST_PLACE = 0.2, 0.8
# variance of a uniform distribution over the square of its width
_UNIFORM_VARIANCE = 1.0 / 12.0


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


def standard_errors_within(information: Array, box: Box) -> Array:
    """Return the Cramer-Rao bound of the standard errors (d,) where the box counts as what was known before.

    Van Trees 1968, Detection, Estimation, and Modulation Theory I, section 2.4 (random parameters), the uniform
    distribution over the box taken as the normal one of its variance. Records that say less than the box would
    otherwise have a bound beyond it, which any answer inside the box meets.
    """
    return from_information(information + np.diag(1.0 / (_UNIFORM_VARIANCE * box.width**2))).standard_error


def start_within(model: Model, names: Sequence[str], start: Array, box: Box) -> Model:
    """Return a model whose unknowns have the bounds of a box, and the values nearest to a start (d,) in it."""
    values = np.clip(start, box.lower, box.upper)
    parameters = model.with_values(dict(zip(names, values.tolist(), strict=True))).parameters
    for name, lower, upper in zip(names, box.lower.tolist(), box.upper.tolist(), strict=True):
        parameters = parameters.bounded(name, lower, upper)
    return model.with_parameters(parameters)
