"""From a trial to a fit: estimate, compare models, predict, and say what the records tell."""

from seatrial.estimation.estimate import Identified, Intervals, Settings, identified
from seatrial.estimation.identify.identify import identify

__all__ = ["Identified", "Intervals", "Settings", "identified", "identify"]
