"""Everything the verdicts rest on, and the few numbers they share."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.models.qi2025 import HEADINGS
from seatrial_studies.own_fit import Ours
from seatrial_studies.qi2025.audit import Audit
from seatrial_studies.qi2025.centre import CentreBias
from seatrial_studies.qi2025.hold import HoldBias
from seatrial_studies.qi2025.published import Algorithm, printed_error
from seatrial_studies.qi2025.repetition import Repetition, Setting

# a value counts as on its bound where it is off by no more than this share of it
NEAR = 0.005
# of the printed means at the lower bound, the least far out (per cent)
SATURATED_FROM = -9.3


@dataclass(frozen=True, eq=False)
class Evidence:
    """Searches, the print worked through, our fits and the cost of a hold by heading, the bias to the middle."""

    made: Repetition
    audited: Audit
    own: dict[int, Ours]
    bias: dict[int, HoldBias]
    centre: CentreBias

    def of_mean(self, setting: Setting, algorithm: Algorithm) -> list[float]:
        """Error of the mean of the runs at each heading, per cent, mean over the coefficients: as the paper prints."""
        return [100.0 * float(np.mean(self.made.searches[setting, h, algorithm].error_of_mean)) for h in HEADINGS]

    def single(self, setting: Setting, algorithm: Algorithm) -> list[float]:
        """Mean error of single runs at each heading, per cent."""
        return [100.0 * float(np.mean(self.made.searches[setting, h, algorithm].mean_error)) for h in HEADINGS]

    def at_lower(self, setting: Setting, algorithm: Algorithm) -> float:
        """Share of the values of all runs that lie on the lower bound."""
        found = [self.made.searches[setting, h, algorithm] for h in HEADINGS]
        return float(np.mean([np.abs(f.points / f.lower - 1.0) < NEAR for f in found]))

    def saturated_means(self, setting: Setting) -> int:
        """Of WHO's 16 means at 90 and 135 degrees, those as near the lower bound as the printed ones."""
        found = [self.made.searches[setting, h, Algorithm.WHO] for h in (90, 135)]
        return sum(int(np.sum(100.0 * (f.points.mean(axis=0) / f.truth - 1.0) <= SATURATED_FROM)) for f in found)

    def seconds(self, algorithm: Algorithm) -> float:
        """Time of a run, mean over the headings."""
        return float(np.mean([self.made.searches[Setting.PAPER, h, algorithm].seconds for h in HEADINGS]))

    @property
    def own_seconds(self) -> float:
        """Time of our noise-free fit, mean over the headings."""
        return float(np.mean([o.seconds for o in self.own.values()]))


def below(errors: Array, heading: int) -> int:
    """Of the eight relative errors (8,), those below IWHO's printed one."""
    return int(np.sum(100.0 * np.abs(errors) < printed_error(heading, Algorithm.IWHO)))


def per_cent(values: list[float]) -> str:
    """Numbers at the three headings."""
    return "/".join(f"{v:.2f}" for v in values) + " %"
