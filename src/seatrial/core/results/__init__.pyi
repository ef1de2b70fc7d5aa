"""Results: fits, designs, tunings, studies and estimates on a stream, described field by field."""

from seatrial.core.results.coefficients import (
    CandidateModel, Coefficient, DisturbanceCandidate, Method, Noise, NoiseModel, Offset, OffsetPopulation, Residuals,
    SessionOffset, Waves, fitted_session, offsets_text, session_offsets_of,
)  # fmt: skip
from seatrial.core.results.campaign import Benchmark, CampaignSummary
from seatrial.core.results.comparison import ComparedFit, Comparison, Difference, JointTest, ManoeuvreDifferences
from seatrial.core.results.design import Actuator, Confirmation, Design, ManoeuvrePrecision, TimedOrder, TrialLimits
from seatrial.core.results.fields import Summarised, Summary
from seatrial.core.results.fit import (
    Collinearity, Consequence, CredibleInterval, Direction, Fit, Identifiability, Posterior, Profile, SearchAttempt,
    Sensitivity, Stability, Symmetry,
)  # fmt: skip
from seatrial.core.results.online import Snapshot
from seatrial.core.results.prediction import (
    Baseline, ChannelScore, Divergence, Extrapolation, IntervalBasis, KStepErrors, Measure, OpenLoopScores, Prediction,
    RowScore, WindowBaseline, WindowScore,
)  # fmt: skip
from seatrial.core.results.published_method import ReferenceEstimate, Search, SearchRestart, SearchTrack
from seatrial.core.results.ship_motions import (
    CommandCurve, CompassCurve, CraftMeasure, FossenMatrix, FrequencyResponse, IntervalEstimate, PointMotion,
    QuadrantMap, RollCharacteristics, Seakeeping, ThrusterCraft,
)  # fmt: skip
from seatrial.core.results.study import Bars, Check, CheckStatus, Claim, Curve, Figure, Matrix, Study, Table, Verdict
from seatrial.core.results.tuning import Tuning
from seatrial.core.results.verification import Verification
from seatrial.numerics.optimise import Solution, Status

__all__ = [
    "Actuator",
    "Bars",
    "Baseline",
    "Benchmark",
    "CampaignSummary",
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
    "Snapshot",
    "Solution",
    "Stability",
    "Status",
    "Study",
    "Summarised",
    "Summary",
    "Symmetry",
    "Table",
    "ThrusterCraft",
    "TimedOrder",
    "TrialLimits",
    "Tuning",
    "Verdict",
    "Verification",
    "Waves",
    "WindowBaseline",
    "WindowScore",
    "fitted_session",
    "offsets_text",
    "session_offsets_of",
]
