"""Everything the verdicts rest on, and the few numbers they share."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.text import significant
from seatrial.core.values import Array
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.controller_cost import ControllerCost
from seatrial_studies.output_error_fit import OutputErrorResults
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.ablation import Ablation
from seatrial_studies.qi2025.audit import WildHorseAudit
from seatrial_studies.qi2025.centre_bias import CentreBias
from seatrial_studies.qi2025.hold_bias import HoldBias
from seatrial_studies.qi2025.published import SearchAlgorithm, printed_error
from seatrial_studies.qi2025.reproduction import SearchSetting, WildHorseReproduction
from seatrial_studies.qi2025.tracking import Tracking
from seatrial_studies.swarm_search import SAMPLES

# a value counts as on its bound where it is off by no more than this share of it
ON_BOUND_SHARE = 0.005
# of the printed means at the lower bound, the least far out (per cent)
SATURATED_FROM_PERCENT = -9.3


@dataclass(frozen=True, eq=False)
class WildHorseEvidence:
    """Searches, the print worked through, our fits and the cost of a hold by heading, the bias to the middle.

    Also the model carried on while its coefficients evolve, IWHO with parts left out, and controllers tuned on
    coefficients, by heading.
    """

    reproduction: WildHorseReproduction
    audit: WildHorseAudit
    output_error: dict[int, OutputErrorResults]
    hold_bias: dict[int, HoldBias]
    centre_bias: CentreBias
    tracking: Tracking
    ablation: Ablation
    controllers: dict[int, tuple[ControllerCost, ...]]

    def errors_of_mean(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> list[float]:
        """Error of the mean of the runs at each heading, per cent, mean over the coefficients: as the paper prints."""
        return [
            100.0 * float(np.mean(self.reproduction.searches[setting, h, algorithm].error_of_mean)) for h in HEADINGS
        ]

    def single_run_errors(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> list[float]:
        """Return the mean error of single runs at each heading, per cent."""
        return [100.0 * float(np.mean(self.reproduction.searches[setting, h, algorithm].mean_error)) for h in HEADINGS]

    def scatter(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> list[float]:
        """Return the standard deviation over the runs at each heading, per cent, mean over the coefficients."""
        return [100.0 * self.reproduction.searches[setting, h, algorithm].scatter for h in HEADINGS]

    def share_at_lower_bound(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> float:
        """Share of the values of all runs that lie on the lower bound."""
        found = [self.reproduction.searches[setting, h, algorithm] for h in HEADINGS]
        return float(np.mean([np.abs(f.points / f.lower_bounds - 1.0) < ON_BOUND_SHARE for f in found]))

    def saturated_means(self, setting: SearchSetting) -> int:
        """Of WHO's 16 means at 90 and 135 degrees, those as near the lower bound as the printed ones."""
        found = [self.reproduction.searches[setting, h, SearchAlgorithm.WHO] for h in (90, 135)]
        return sum(
            int(np.sum(100.0 * (f.points.mean(axis=0) / f.truth - 1.0) <= SATURATED_FROM_PERCENT)) for f in found
        )

    def evaluations(self, algorithm: SearchAlgorithm) -> int:
        """Return the candidates that a run judges in the paper's setting."""
        return int(self.reproduction.searches[SearchSetting.PAPER, HEADINGS[0], algorithm].evaluations[0])

    def run_count(self, setting: SearchSetting) -> int:
        """Return the runs of a setting at each heading of the tables."""
        return len(self.reproduction.searches[setting, HEADINGS[0], SearchAlgorithm.IWHO].points)

    @property
    def ablation_runs(self) -> int:
        """Return the runs of IWHO with parts left out, and of IWHO complete beside them, at each heading."""
        return len(self.ablation.errors[SearchSetting.PAPER, None, HEADINGS[0]])

    @property
    def output_error_evaluations(self) -> int:
        """Return the evaluations of our noise-free fit, the most at any heading."""
        return max(o.evaluations for o in self.output_error.values())

    def search_seconds(self, algorithm: SearchAlgorithm) -> float:
        """Time of a run, mean over the headings."""
        return float(np.mean([self.reproduction.searches[SearchSetting.PAPER, h, algorithm].seconds for h in HEADINGS]))

    @property
    def bound_ratio(self) -> float:
        """Return the root mean square of our errors in noise over their Cramer-Rao bound, all headings."""
        return float(np.sqrt(np.mean([o.error_over_bound**2 for o in self.output_error.values()])))

    @property
    def output_error_seconds(self) -> float:
        """Time of our noise-free fit, mean over the headings."""
        return float(np.mean([o.seconds for o in self.output_error.values()]))


def simulated_steps(evaluations: int, *, has_slopes: bool) -> int:
    """Return the steps of evaluations of the whole record, each slope by a coefficient counted as one simulation."""
    return evaluations * (SAMPLES - 1) * (1 + len(COEFFICIENTS) * has_slopes)


def count_below_printed(errors: Array, heading: int) -> int:
    """Of the eight relative errors (8,), those below IWHO's printed one."""
    return int(np.sum(100.0 * np.abs(errors) < printed_error(heading, SearchAlgorithm.IWHO)))


def percent_text(values: list[float]) -> str:
    """Numbers at the three headings."""
    return "/".join(f"{v:.2f}" for v in values) + " %"


def range_text(values: list[float]) -> str:
    """Return the least and the largest number, two digits each."""
    return f"{significant(min(values), 2)} to {significant(max(values), 2)} %"
