"""Directions in parameter space that the records do not determine, named before any number is printed for them."""

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.estimation.information.directions import signed_terms

# curvature over the largest, unit diagonal, that counts as zero: rounding of the normal equations
_SINGULAR = 1e-11
# least component of a direction that is named, and most that are, ours
_MIN_INFLUENCE, _MAX_NAMED = 0.1, 8


def weakest_direction(hessian: Array, names: tuple[str, ...], values: Array) -> tuple[float, str]:
    """Relative curvature along the weakest direction and the direction in words, e.g. ``1 N_v +1 N_r +1.9 J_z``.

    The numbers are relative changes of the parameters, in units of the median one; those that move the outputs most
    come first. The Hessian is scaled to unit diagonal; a parameter without any influence gives curvature 0 and is
    named alone.
    """
    diagonal = np.diag(hessian)
    size = np.maximum(np.abs(values), 1e-3)  # of coefficients that are nearly zero, in their unit; chosen
    # rounding of double precision; chosen
    silent = np.flatnonzero(diagonal * size**2 <= 1e-14 * np.max(diagonal * size**2))
    if len(silent):
        return 0.0, names[int(silent[0])]
    scale = 1.0 / np.sqrt(diagonal)
    curvature, vectors = np.linalg.eigh(hessian * scale[:, None] * scale[None, :])
    influence = vectors[:, 0]
    order = [i for i in np.argsort(-np.abs(influence)) if abs(influence[i]) > _MIN_INFLUENCE][:_MAX_NAMED]
    change = influence[order] * scale[order] / np.copysign(size, values)[order]
    change = change / (np.sign(change[0]) * np.median(np.abs(change)))
    terms = signed_terms({names[i]: float(c) for i, c in zip(order, change, strict=True)}, "+.2g")
    return float(curvature[0] / curvature[-1]), terms.removeprefix("+")


def refuse_singular(hessian: Array, names: tuple[str, ...], values: Array) -> None:
    """Refuse a problem with an exactly free direction.

    Raises:
        InputError: the direction that is not determined, and what to do.
    """
    curvature, direction = weakest_direction(hessian, names, values)
    if curvature < _SINGULAR:
        raise InputError(
            f"the records do not determine the direction {direction} (relative change of each parameter): moving along "
            "it changes no output; fix one of these parameters under [model.fixed], or give it a prior"
        )
