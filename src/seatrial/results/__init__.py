"""Solutions, fits and studies read in the field's terms."""

from seatrial.optimise import Solution, Status
from seatrial.results.design import Actuator, Confirmation, Design, Limits, Order, Worth
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
from seatrial.results.rival import Rival, Sailed
from seatrial.results.rolling import Estimated, Rolling
from seatrial.results.seakeeping import PointMotion, Seakeeping
from seatrial.results.study import Bars, Check, Claim, Curve, Figure, Matrix, Study, Table, Verdict

__all__ = [
    "Actuator",
    "Bars",
    "Check",
    "Claim",
    "Coefficient",
    "Collinearity",
    "Confirmation",
    "Consequence",
    "Curve",
    "Design",
    "Direction",
    "Disturbance",
    "Estimated",
    "Extrapolation",
    "Figure",
    "Fit",
    "Identifiability",
    "Limits",
    "Margin",
    "Matrix",
    "Measure",
    "Member",
    "Method",
    "Noise",
    "Offset",
    "Order",
    "PointMotion",
    "Prediction",
    "Profile",
    "Residuals",
    "Rival",
    "Rolling",
    "Sailed",
    "Seakeeping",
    "Sensitivity",
    "Solution",
    "Stability",
    "Status",
    "Study",
    "Symmetry",
    "Table",
    "Verdict",
    "Worth",
]
