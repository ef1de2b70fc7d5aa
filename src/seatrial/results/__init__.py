"""Solutions, fits and studies read in the field's terms."""

from seatrial.optimise import Solution, Status
from seatrial.results.fit import Coefficient, Fit, Measure, Method, Noise, Offset, Prediction, Residuals
from seatrial.results.study import Check, Claim, Curve, Figure, Study, Table, Verdict

__all__ = [
    "Check",
    "Claim",
    "Coefficient",
    "Curve",
    "Figure",
    "Fit",
    "Measure",
    "Method",
    "Noise",
    "Offset",
    "Prediction",
    "Residuals",
    "Solution",
    "Status",
    "Study",
    "Table",
    "Verdict",
]
