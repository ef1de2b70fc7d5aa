"""From a trial to a fit: estimate, compare models, predict, and say what the records tell."""

from seatrial.estimation.estimate import Estimation, IntervalMethod, Settings, estimate_model
from seatrial.estimation.identify.identify import identify

__all__ = ["Estimation", "IntervalMethod", "Settings", "estimate_model", "identify"]
