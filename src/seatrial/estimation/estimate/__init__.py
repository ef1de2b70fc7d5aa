"""Start, search, criterion, intervals: from runs to an estimate (the decision table of docs/estimation.md)."""

from seatrial.estimation.estimate.assemble import Runs, training_runs
from seatrial.estimation.estimate.fit import Beginning, Estimation, begin_estimate, estimate_model, with_segment_seconds
from seatrial.estimation.estimate.settings import (
    INITIAL_STATE_SHIP_LENGTHS,
    EstimatorOptions,
    IntervalMethod,
    ship_length_seconds,
)

__all__ = [
    "INITIAL_STATE_SHIP_LENGTHS", "Beginning", "Estimation", "EstimatorOptions", "IntervalMethod", "Runs",
    "begin_estimate", "estimate_model", "ship_length_seconds", "training_runs", "with_segment_seconds",
]  # fmt: skip
