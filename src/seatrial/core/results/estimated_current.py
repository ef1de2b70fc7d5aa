"""The current that a fit estimated for the session of a run."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.results.coefficients import Offset
from seatrial.core.results.prediction import Prediction

CURRENT_NORTH, CURRENT_EAST = "current_north", "current_east"
"""Parameters of a session: velocity of the water towards north and east, m/s."""


@dataclass(frozen=True)
class EstimatedCurrent:
    """Velocity of the water over ground towards north and east with standard errors, m/s."""

    north: float
    east: float
    north_error: float = 0.0
    east_error: float = 0.0

    @property
    def speed(self) -> float:
        """The current's speed, m/s."""
        return math.hypot(self.north, self.east)


def estimated_current(p: Prediction, offsets: Sequence[Offset]) -> EstimatedCurrent | None:
    """Return the current of a run's session; None where none was estimated, as of a session that was not fitted.

    offsets: of the fit.
    """
    north, east = (_of_session(p, offsets, name) for name in (CURRENT_NORTH, CURRENT_EAST))
    if north is None or east is None:
        return None
    return EstimatedCurrent(north.estimate, east.estimate, north.standard_error or 0.0, east.standard_error or 0.0)


def _of_session(p: Prediction, offsets: Sequence[Offset], name: str) -> Offset | None:
    return next((o for o in offsets if o.name == name and o.group == p.session), None)
