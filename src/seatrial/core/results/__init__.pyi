"""Results: fits, designs, tunings, studies and estimates on a stream, described field by field."""

from seatrial.core.results.coefficients import (
    CandidateModel, Coefficient, DisturbanceCandidate, Method, Noise, NoiseModel, Offset, OffsetPopulation, Residuals,
    Waves,
)  # fmt: skip
from seatrial.core.results.comparison import ComparedFit, Comparison, Difference, JointTest, ManoeuvreDifferences
from seatrial.core.results.design import Actuator, Confirmation, Design, ManoeuvrePrecision, TimedOrder, TrialLimits
from seatrial.core.results.fit import Fit
from seatrial.core.results.frequency_response import FrequencyResponse
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
from seatrial.core.results.k_step import KStepErrors
from seatrial.core.results.posterior import CredibleInterval, Posterior
from seatrial.core.results.prediction import (
    Baseline,
    Divergence,
    Extrapolation,
    IntervalBasis,
    Measure,
    OpenLoopScores,
    Prediction,
    RowScore,
)
from seatrial.core.results.search_attempts import SearchAttempt
from seatrial.core.results.ship_motions import IntervalEstimate, PointMotion, RollCharacteristics, Seakeeping
from seatrial.core.results.session_offset import SessionOffset, fitted_session, offsets_text, session_offsets_of
from seatrial.core.results.study import Bars, Check, CheckStatus, Claim, Curve, Figure, Matrix, Study, Table, Verdict
from seatrial.core.results.published_method import ReferenceEstimate, Search, SearchRestart, SearchTrack
from seatrial.core.results.summary import Summary
from seatrial.core.results.thruster_craft import (
    CommandCurve,
    CompassCurve,
    CraftMeasure,
    FossenMatrix,
    QuadrantMap,
    ThrusterCraft,
)
from seatrial.core.results.window_scores import ChannelScore, WindowBaseline, WindowScore
from seatrial.numerics.optimise import Solution, Status

__all__ = [
    "Actuator",
    "Bars",
    "Baseline",
    "CandidateModel",
    "ChannelScore",
    "Check",
    "CheckStatus",
    "Claim",
    "Coefficient",
    "Collinearity",
    "CommandCurve",
    "ComparedFit",
    "Comparison",
    "CompassCurve",
    "Confirmation",
    "Consequence",
    "CraftMeasure",
    "CredibleInterval",
    "Curve",
    "Design",
    "Difference",
    "Direction",
    "DisturbanceCandidate",
    "Divergence",
    "Extrapolation",
    "Figure",
    "Fit",
    "FossenMatrix",
    "FrequencyResponse",
    "Identifiability",
    "IntervalBasis",
    "IntervalEstimate",
    "JointTest",
    "KStepErrors",
    "ManoeuvreDifferences",
    "ManoeuvrePrecision",
    "Matrix",
    "Measure",
    "Method",
    "Noise",
    "NoiseModel",
    "Offset",
    "OffsetPopulation",
    "OpenLoopScores",
    "PointMotion",
    "Posterior",
    "Prediction",
    "Profile",
    "QuadrantMap",
    "ReferenceEstimate",
    "Residuals",
    "RollCharacteristics",
    "RowScore",
    "Seakeeping",
    "Search",
    "SearchAttempt",
    "SearchRestart",
    "SearchTrack",
    "Sensitivity",
    "SessionOffset",
    "Solution",
    "Stability",
    "Status",
    "Study",
    "Summary",
    "Symmetry",
    "Table",
    "ThrusterCraft",
    "TimedOrder",
    "TrialLimits",
    "Verdict",
    "Waves",
    "WindowBaseline",
    "WindowScore",
    "fitted_session",
    "offsets_text",
    "session_offsets_of",
]
