"""Everything the tables, figures and verdicts of the study rest on."""

from dataclasses import dataclass

from seatrial.estimation.information.sensitivity import IndirectSensitivity, UniqueSensitivity
from seatrial_studies.song2025.audit import Audit
from seatrial_studies.song2025.discrimination import Discrimination
from seatrial_studies.song2025.generalisation import Outcome
from seatrial_studies.song2025.published import Column, Run
from seatrial_studies.song2025.repetition import Repetition, Row


@dataclass(frozen=True, eq=False)
class Evidence:
    """Numbers of one run of the study.

    Attributes:
        turn_drift: deg in the steady 35 deg turn, truth and improved column mended.
    """

    made: Repetition
    audited: Audit
    outcomes: tuple[Outcome, ...]
    lost: Discrimination
    indirect: IndirectSensitivity
    unique: UniqueSensitivity
    turn_drift: tuple[float, float]

    def outcome(self, column: Column, run: Run) -> Outcome:
        """The mended column's run."""
        return next(o for o in self.outcomes if o.reading.column is column and o.run is run)

    def best_rival(self) -> Row:
        """The regression with the smallest median error in sensor noise."""
        return min((r for r in self.made.noisy if not r.note), key=lambda r: r.median)


def per_cent(value: float) -> str:
    """A share as text."""
    share = 100.0 * value
    return f"{share:.0f} %" if share >= 1000.0 else f"{share:.3g} %"
