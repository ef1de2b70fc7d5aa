"""How far the motions of a run spread: what errors of its prediction are compared with."""

import math
from collections.abc import Container, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record

MOTIONS = {"psi_deg": ("psi",), "position_m": ("x0", "y0"), "z": ("z",), "theta_deg": ("theta",), "phi_deg": ("phi",)}
"""Name of an error, as in `Prediction.rms` -> the channels of that motion."""
HEADING_SPREAD = math.pi / math.sqrt(3.0)
"""rad, standard deviation of a heading that points anywhere alike: turns on and on spread it no further."""
HELD_COURSE_SPREAD = math.radians(10.0)
"""rad, by which a heading that is held over a whole run counts as spread: what a helmsman leaves of it is no motion to
measure a model by; chosen: of a 10/10 zigzag."""
_HELD_WITHIN = math.radians(5.0)  # standard deviation of a heading below which it is held; chosen: of small zigzags
_DEGREES = math.degrees(1.0)


@dataclass(frozen=True)
class MotionSpread:
    """Standard deviation of a motion in the unit of its error.

    is_turning: the heading spreads further than all directions alike do, so that it is theirs. is_held: the heading is
    held over the run, so that it is that of a small turn.
    """

    size: float
    is_turning: bool = False
    is_held: bool = False


def motion_spread(name: str, motions: Sequence[Array]) -> MotionSpread:
    """Return the spread of the channels of a motion together; name: of its error; motions: shape (n,) each, SI."""
    spread = math.sqrt(sum(float(np.nanvar(motion)) for motion in motions))
    is_turning = name == "psi_deg" and spread > HEADING_SPREAD
    size = (HEADING_SPREAD if is_turning else spread) * (_DEGREES if name.endswith("_deg") else 1.0)
    return MotionSpread(size, is_turning)


def motion_spreads(names: Container[str], measured: Record) -> dict[str, MotionSpread]:
    """Return what errors of these names over a whole run are compared with, as far as it holds their channels."""
    spreads = _own_spreads(names, measured)
    heading = spreads.get("psi_deg")
    if heading is not None and heading.size < _DEGREES * _HELD_WITHIN:
        spreads["psi_deg"] = MotionSpread(_DEGREES * HELD_COURSE_SPREAD, is_held=True)
    return spreads


def _own_spreads(names: Container[str], measured: Record) -> dict[str, MotionSpread]:
    compared = (name for name, channels in MOTIONS.items() if name in names and all(c in measured for c in channels))
    return {name: motion_spread(name, [measured[c] for c in MOTIONS[name]]) for name in compared}
