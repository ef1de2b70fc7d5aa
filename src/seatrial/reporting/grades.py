"""How well a run is predicted, as a grade: its error as a share of the motion itself, on one scale for every page."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from seatrial.core.results import Fit, Prediction
from seatrial.core.text.numbers import significant
from seatrial.reporting.runs import ERROR_LABELS

_DEGREES = math.degrees(1.0)
_MOTIONS = {"psi_deg": ("psi",), "position_m": ("x0", "y0"), "z": ("z",), "theta_deg": ("theta",), "phi_deg": ("phi",)}


class Grade(StrEnum):
    """How a whole run is predicted open loop, the best first."""

    CLOSELY = "closely"
    WELL = "well"
    ROUGHLY = "roughly"
    POORLY = "poorly"
    NOT = "not at all"


# grade -> largest error over the run as a share of the standard deviation of that motion; chosen but for the last: from
# 1 on the mean of the motion is nearer to it than the prediction
_LIMITS = {Grade.CLOSELY: 0.1, Grade.WELL: 0.3, Grade.ROUGHLY: 0.7, Grade.POORLY: 1.0}
SCALE = f"{', '.join(f'{grade} to {limit:g}' for grade, limit in _LIMITS.items())}"
"""The scale in words, for where a grade stands."""


@dataclass(frozen=True)
class ErrorShare:
    """An error over a whole run, as a share of the standard deviation of that motion; name: as in `Prediction.rms`."""

    name: str
    share: float

    @property
    def grade(self) -> Grade:
        """What is said of such an error."""
        return next((grade for grade, limit in _LIMITS.items() if self.share <= limit), Grade.NOT)

    @property
    def needs_attention(self) -> bool:
        """Whether the error is marked: the run is predicted roughly at best."""
        return self.grade not in (Grade.CLOSELY, Grade.WELL)


def largest_error_share(p: Prediction) -> ErrorShare | None:
    """Return the error of a run that is the largest share of its own motion; None where none can be compared."""
    shares = []
    for name, channels in _MOTIONS.items():
        if name in p.rms and all(c in p.measured for c in channels):
            spread = math.sqrt(sum(float(np.nanvar(p.measured[c])) for c in channels))
            size = spread * (_DEGREES if name.endswith("_deg") else 1.0)
            shares.append(ErrorShare(name, p.rms[name] / size if size > 0.0 else math.inf))
    return max(shares, key=lambda one: one.share, default=None)


def worst_share(predictions: Sequence[Prediction]) -> ErrorShare | None:
    """Return the largest of all errors as a share of its motion; None where none can be compared."""
    shares = [share for p in predictions if (share := largest_error_share(p)) is not None]
    return max(shares, key=lambda one: one.share, default=None)


def is_missed(fit: Fit) -> bool:
    """Return whether a held-out run is not predicted at all: it diverges, or its mean is nearer."""
    largest = worst_share(fit.validation)
    is_lost = largest is not None and largest.grade is Grade.NOT
    return is_lost or any(p.divergence is not None for p in fit.validation)


def share_sentence(predictions: Sequence[Prediction]) -> str:
    """Return the largest of all errors as a share of its motion, its grade and the scale; empty where unknown."""
    largest = worst_share(predictions)
    if largest is None:
        return ""
    return (
        f"in {ERROR_LABELS[largest.name][0]} {significant(largest.share, 2)} of the standard deviation of the motion "
        f"itself: {largest.grade} ({SCALE})"
    )
