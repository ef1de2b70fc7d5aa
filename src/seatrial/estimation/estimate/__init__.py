"""Start, search, criterion, intervals: from records to an estimate (the decision table of docs/estimation.md)."""

from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import IntervalMethod, Settings

__all__ = ["Estimation", "IntervalMethod", "Settings", "estimate_model"]
