"""From a trial to a fit: estimate, compare models, predict, and state what the records determine."""

from seatrial.estimation.estimate import Estimation, EstimatorOptions, IntervalMethod, Runs, estimate_model
from seatrial.estimation.identify.identify import identify
from seatrial.estimation.identify.model_selection import HOLDOUT_WINDOW_SHIP_LENGTHS

__all__ = [
    "HOLDOUT_WINDOW_SHIP_LENGTHS",
    "Estimation",
    "EstimatorOptions",
    "IntervalMethod",
    "Runs",
    "estimate_model",
    "identify",
]
