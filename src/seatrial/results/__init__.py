"""Solutions, fits and studies read in the field's terms."""

from seatrial.optimise import Solution, Status
from seatrial.results.fit import (
    Coefficient,
    Disturbance,
    Extrapolation,
    Fit,
    Margin,
    Measure,
    Member,
    Method,
    Noise,
    Offset,
    Prediction,
    Residuals,
)
from seatrial.results.identifiability import (
    Collinearity,
    Consequence,
    Direction,
    Identifiability,
    Profile,
    Sensitivity,
    Stability,
    Symmetry,
)
from seatrial.results.seakeeping import PointMotion, Seakeeping
from seatrial.results.study import Check, Claim, Curve, Figure, Study, Table, Verdict

__all__ = [
    "Check",
    "Claim",
    "Coefficient",
    "Collinearity",
    "Consequence",
    "Curve",
    "Direction",
    "Disturbance",
    "Extrapolation",
    "Figure",
    "Fit",
    "Identifiability",
    "Margin",
    "Measure",
    "Member",
    "Method",
    "Noise",
    "Offset",
    "PointMotion",
    "Prediction",
    "Profile",
    "Residuals",
    "Seakeeping",
    "Sensitivity",
    "Solution",
    "Stability",
    "Status",
    "Study",
    "Symmetry",
    "Table",
    "Verdict",
]
