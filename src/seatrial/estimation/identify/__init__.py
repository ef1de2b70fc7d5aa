"""From a trial to a fit: estimate, compare models, predict, and state what the records determine."""

from seatrial.estimation.estimate import Estimation, EstimatorOptions, IntervalMethod, Runs, estimate_model
from seatrial.estimation.identify.identify import identify

__all__ = ["Estimation", "EstimatorOptions", "IntervalMethod", "Runs", "estimate_model", "identify"]
