"""Results in the terms of the field: fits, designs, tunings, studies."""

from seatrial.core.results.baseline import Baseline, OpenLoopScores
from seatrial.core.results.design import Actuator, Confirmation, Design, ManoeuvrePrecision, TimedOrder, TrialLimits
from seatrial.core.results.fit import (
    CandidateModel,
    Coefficient,
    Extrapolation,
    Fit,
    IntervalBasis,
    Measure,
    Method,
    Noise,
    NoiseModel,
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
from seatrial.core.results.roll import IntervalEstimate, RollCharacteristics
from seatrial.core.results.seakeeping import PointMotion, Seakeeping
from seatrial.core.results.study import Bars, Check, Claim, Curve, Figure, Matrix, Study, Table, Verdict
from seatrial.numerics.optimise import Solution, Status

__all__ = [
    "Actuator",
    "Bars",
    "Baseline",
    "CandidateModel",
    "Check",
    "Claim",
    "Coefficient",
    "Collinearity",
    "Confirmation",
    "Consequence",
    "Curve",
    "Design",
    "Direction",
    "Extrapolation",
    "Figure",
    "Fit",
    "Identifiability",
    "IntervalBasis",
    "IntervalEstimate",
    "ManoeuvrePrecision",
    "Matrix",
    "Measure",
    "Method",
    "Noise",
    "NoiseModel",
    "Offset",
    "OpenLoopScores",
    "PointMotion",
    "Prediction",
    "Profile",
    "Residuals",
    "RollCharacteristics",
    "Seakeeping",
    "Sensitivity",
    "Solution",
    "Stability",
    "Status",
    "Study",
    "Symmetry",
    "Table",
    "TimedOrder",
    "TrialLimits",
    "Verdict",
]
