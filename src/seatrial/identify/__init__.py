"""Start, fit, intervals, prediction: from a trial to a fit."""

from seatrial.identify.fit import Identified, identified
from seatrial.identify.identify import identify
from seatrial.identify.settings import Intervals, Settings

__all__ = ["Identified", "Intervals", "Settings", "identified", "identify"]
