"""Solutions, fits and studies read in the field's terms."""

from seatrial.core.results.design import Actuator, Confirmation, Design, Limits, Order, Worth
from seatrial.core.results.fit import (
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
from seatrial.core.results.identifiability import (
    Collinearity,
    Consequence,
    Direction,
    Identifiability,
    Profile,
    Sensitivity,
    Stability,
    Symmetry,
)
from seatrial.core.results.rival import Rival, Sailed
from seatrial.core.results.rolling import Estimated, Rolling
from seatrial.core.results.seakeeping import PointMotion, Seakeeping
from seatrial.core.results.study import Bars, Check, Claim, Curve, Figure, Matrix, Study, Table, Verdict
from seatrial.numerics.optimise import Solution, Status

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
