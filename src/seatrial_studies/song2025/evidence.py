"""Everything the tables, figures and verdicts of the study rest on."""

from dataclasses import dataclass

from seatrial_studies.song2025.audit import SupportVectorAudit
from seatrial_studies.song2025.coefficient_sensitivity import IndirectSensitivity, UniqueSensitivity
from seatrial_studies.song2025.discrimination import Discrimination
from seatrial_studies.song2025.generalisation import RunComparison
from seatrial_studies.song2025.published import PublishedManoeuvre, Table2Column
from seatrial_studies.song2025.reproduction import EstimatorResult, SupportVectorReproduction


@dataclass(frozen=True, eq=False)
class SupportVectorEvidence:
    """Numbers of one run of the study.

    Attributes:
        turn_drift: deg in the steady 35 deg turn, truth and improved column corrected.
    """

    reproduction: SupportVectorReproduction
    audit: SupportVectorAudit
    comparisons: tuple[RunComparison, ...]
    discrimination: Discrimination
    indirect_sensitivity: IndirectSensitivity
    unique_sensitivity: UniqueSensitivity
    turn_drift: tuple[float, float]

    def comparison(self, column: Table2Column, run: PublishedManoeuvre) -> RunComparison:
        """Return the run of a corrected column."""
        return next(o for o in self.comparisons if o.coefficient_set.column is column and o.run is run)

    def best_regression(self) -> EstimatorResult:
        """Return the regression with the smallest median error in sensor noise."""
        return min((r for r in self.reproduction.noisy_results if not r.note), key=lambda r: r.median_error)


def percent_text(value: float) -> str:
    """Return a share in per cent as text."""
    share = 100.0 * value
    return f"{share:.0f} %" if share >= 1000.0 else f"{share:.3g} %"
