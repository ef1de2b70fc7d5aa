"""Everything the tables, figures and verdicts of the study rest on."""

from dataclasses import dataclass

from seatrial_studies.controller_cost import ControllerCost
from seatrial_studies.song2025.audit import SupportVectorAudit
from seatrial_studies.song2025.cleaning_ablation import CleaningAblation
from seatrial_studies.song2025.coefficient_sensitivity import IndirectSensitivity, UniqueSensitivity
from seatrial_studies.song2025.craft_models import CORRECTED
from seatrial_studies.song2025.discrimination import Discrimination
from seatrial_studies.song2025.generalisation import RunComparison
from seatrial_studies.song2025.published import PublishedManoeuvre, Table2Column
from seatrial_studies.song2025.reproduction import EstimatorResult, SupportVectorReproduction
from seatrial_studies.song2025.speed_range import SpeedPrediction


@dataclass(frozen=True, eq=False)
class SupportVectorEvidence:
    """Numbers of one run of the study.

    Attributes:
        own_comparisons: runs of our own improved pipeline, noise-free series.
        speeds: predictions at other speeds; controllers: autopilots tuned on each method's coefficients.
        turn_drift: deg in the steady 35 deg turn, truth and improved column corrected.
    """

    reproduction: SupportVectorReproduction
    audit: SupportVectorAudit
    comparisons: tuple[RunComparison, ...]
    discrimination: Discrimination
    indirect_sensitivity: IndirectSensitivity
    unique_sensitivity: UniqueSensitivity
    turn_drift: tuple[float, float]
    own_comparisons: tuple[RunComparison, ...]
    ablation: CleaningAblation
    speeds: tuple[SpeedPrediction, ...]
    controllers: tuple[ControllerCost, ...]

    def comparison(self, column: Table2Column, run: PublishedManoeuvre) -> RunComparison:
        """Return the run of a corrected column."""
        title = next(one.title for one in CORRECTED if one.column is column)
        return next(o for o in self.comparisons if o.title == title and o.run is run)

    def own_comparison(self, run: PublishedManoeuvre) -> RunComparison:
        """Return the run of our own pipeline's coefficients."""
        return next(o for o in self.own_comparisons if o.run is run)

    def best_regression(self) -> EstimatorResult:
        """Return the regression with the smallest median error in sensor noise."""
        return min((r for r in self.reproduction.noisy_results if not r.note), key=lambda r: r.median_error)


def percent_text(value: float) -> str:
    """Return a share in per cent as text."""
    share = 100.0 * value
    return f"{share:.0f} %" if share >= 1000.0 else f"{share:.3g} %"
