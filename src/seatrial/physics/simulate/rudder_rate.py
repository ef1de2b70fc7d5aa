"""How fast the rudder of a simulated manoeuvre moves: as fast as the runs show it, at least as SOLAS requires."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from seatrial.core.values import Array, Record
from seatrial.physics.manoeuvres import REACH_PERCENTILE
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE

RUDDER_RATE = "rudder_rate"
"""Key of the fastest rate of the training runs [rad/s] in what a model file says they cover."""
MOVE_SHARE = 0.5
"""Share of the range of rudder angles that a sustained move covers: noise and small corrections do not; chosen."""
CLEARLY_FASTER = 1.2
"""Times the rate that SOLAS requires from which recorded moves are faster: slopes are read to some 10 %; chosen."""
_SPIKE = 3  # samples of the running median: a single bad reading is no move; the least a median can have


@dataclass(frozen=True)
class RudderRate:
    """Rate of a rudder, rad/s, and where it is from."""

    value: float
    origin: str

    @property
    def text(self) -> str:
        """A phrase for people."""
        return f"rudder rate {math.degrees(self.value):.3g} deg/s, {self.origin}"


def rudder_rate(scale: float, recorded: float | None = None) -> RudderRate:
    """Return the rate that manoeuvres are steered with: that of the records, where clearly faster than SOLAS requires.

    Args:
        scale: of the ship, full scale over that of the trials; a rate grows with its root (Froude's law).
        recorded: fastest sustained move of the training runs [rad/s], as `sustained_rudder_rate` has it.
    """
    required = SOLAS_SLEW_RATE * math.sqrt(scale)
    if recorded is not None and recorded >= CLEARLY_FASTER * required:
        return RudderRate(recorded, "the fastest of the training runs")
    return RudderRate(required, "as SOLAS requires, at the ship's scale" if scale != 1.0 else "as SOLAS requires")


def sustained_rudder_rate(record: Record) -> float | None:
    """Return the fastest rate at which the rudder moves through half its range [rad/s]; None: it hardly moves.

    A run of fewer samples, one whose rudder needs longer than at SOLAS's rate at full scale, and one without rudder
    angles have none. A move between two samples counts as taking one sample interval.
    """
    if "delta" not in record or len(record) <= _SPIKE:
        return None
    angles = np.median(sliding_window_view(record["delta"], _SPIKE), axis=1)
    if not np.isfinite(angles).any():
        return None
    least, most = np.nanpercentile(angles, (100.0 - REACH_PERCENTILE, REACH_PERCENTILE))
    threshold = MOVE_SHARE * float(most - least)
    slowest = math.ceil(threshold / (SOLAS_SLEW_RATE * record.dt))
    for steps in range(1, min(slowest, len(angles) - 1) + 1):
        largest = _largest_move(angles, steps)
        if largest >= threshold:
            return largest / (steps * record.dt)
    return None


def _largest_move(angles: Array, steps: int) -> float:
    moves = np.abs(angles[steps:] - angles[:-steps])
    return float(np.nanmax(moves, initial=0.0))
