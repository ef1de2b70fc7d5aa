"""Start, search, criterion, intervals: from records to an estimate (the decision table of docs/estimation.md)."""

from seatrial.estimation.estimate.fit import Identified, identified
from seatrial.estimation.estimate.settings import Intervals, Settings

__all__ = ["Identified", "Intervals", "Settings", "identified"]
