"""Solutions, and fits read in the field's terms."""

from seatrial.results.fit import Coefficient, Fit, Measure, Method, Noise, Offset, Prediction, Residuals
from seatrial.optimise import Solution, Status

__all__ = [
    "Coefficient",
    "Fit",
    "Measure",
    "Method",
    "Noise",
    "Offset",
    "Prediction",
    "Residuals",
    "Solution",
    "Status",
]
