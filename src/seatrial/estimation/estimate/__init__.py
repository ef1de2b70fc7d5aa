"""Start, search, criterion, intervals: from runs to an estimate (the decision table of docs/estimation.md)."""

from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.settings import EstimatorOptions, IntervalMethod

__all__ = ["Estimation", "EstimatorOptions", "IntervalMethod", "Runs", "estimate_model"]
