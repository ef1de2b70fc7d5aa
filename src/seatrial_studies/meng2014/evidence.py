"""Everything the verdicts rest on, and the few numbers they share."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.controller_cost import ControllerCost
from seatrial_studies.meng2014.cloud_weight import CloudWeight
from seatrial_studies.meng2014.reproduction import HEADINGS, BoxPlacement, CloudSwarmReproduction, SwarmAlgorithm
from seatrial_studies.output_error_fit import OutputErrorResults
from seatrial_studies.swarm_search import RepeatedSearches

# relative difference of coefficients up to which two swarms have found the same minimum; our choice
SAME_POINT = 1e-3


@dataclass(frozen=True, eq=False)
class UndetectedChange:
    """Wrong coefficients that follow the record: relative changes (8,), rms of heave [m] and of pitch [deg]."""

    relative_change: Array
    heave_rms: float
    pitch_rms: float


@dataclass(frozen=True, eq=False)
class TwelveUnknowns:
    """The twelve unknowns of the print.

    Attributes:
        curvatures: of the flattest direction over the steepest, by what moves the ship; 1: equally steep.
        errors: largest relative error of our noise-free fit of all twelve in waves with a fin, by heading.
    """

    curvatures: dict[str, float]
    errors: dict[int, float]


@dataclass(frozen=True, eq=False)
class CloudSwarmEvidence:
    """All numbers of the study."""

    reproduction: CloudSwarmReproduction
    output_error: dict[int, OutputErrorResults]
    twelve_unknowns: TwelveUnknowns
    undetected_change: UndetectedChange
    cloud_weight: CloudWeight
    controllers: dict[int, tuple[ControllerCost, ...]]

    def off_centre(self, algorithm: SwarmAlgorithm) -> dict[int, RepeatedSearches]:
        """Return the searches in the box off centre by heading."""
        return {h: self.reproduction.searches[BoxPlacement.OFF_CENTRE, h, algorithm] for h in HEADINGS}

    def mean_error(self, setting: BoxPlacement, algorithm: SwarmAlgorithm, heading: int) -> float:
        """Return the mean relative error over coefficients and runs, per cent."""
        return 100.0 * float(np.mean(self.reproduction.searches[setting, heading, algorithm].mean_error))

    def output_error_percent(self, heading: int) -> float:
        """Ours with the same noise, per cent."""
        return 100.0 * float(np.mean(np.abs(self.output_error[heading].noisy_errors)))

    @property
    def noise_allowance(self) -> float:
        """Return the excess of fitness that the noise explains.

        A sum of squares of n residuals larger by one variance has a root larger by 1 / (2 n).
        """
        return 0.5 / self.reproduction.seas[HEADINGS[0]][0].measured.size

    def is_stuck(self, searches: dict[int, RepeatedSearches]) -> NDArray[np.bool_]:
        """Runs off centre that end above the better fitness of both swarms by more than noise, (headings, runs)."""
        ends = [self.reproduction.excess_fitness(h, found)[:, -1] for h, found in searches.items()]
        return np.array(ends) > self.noise_allowance

    def iterations_needed(self, searches: dict[int, RepeatedSearches]) -> Array:
        """Return the iteration at which runs reach that fitness within noise, (headings, runs); infinite if never."""
        excess = np.array([self.reproduction.excess_fitness(h, found) for h, found in searches.items()])
        reached = excess <= self.noise_allowance
        return np.where(reached.any(axis=2), reached.argmax(axis=2).astype(np.float64), np.inf)

    @property
    def output_error_ratio(self) -> float:
        """Return the root mean square of our errors in noise over their Cramer-Rao bound, all headings."""
        return float(np.sqrt(np.mean([self.output_error[h].error_over_bound ** 2 for h in HEADINGS])))

    @property
    def same_minimum_share(self) -> float:
        """Return the share of runs off centre in which both swarms end at the same point."""
        icpso, pso = (self.off_centre(a) for a in SwarmAlgorithm)
        away = [np.abs(icpso[h].errors - pso[h].errors).max(axis=1) for h in HEADINGS]
        return float(np.mean(np.array(away) < SAME_POINT))

    @property
    def swarm_ratio(self) -> float:
        """Return the same of ICPSO's errors off centre."""
        pairs = [
            (f.errors, self.output_error[h].cramer_rao_bound) for h, f in self.off_centre(SwarmAlgorithm.ICPSO).items()
        ]
        return float(np.sqrt(np.mean([(errors / bound) ** 2 for errors, bound in pairs])))

    @property
    def time_ratio(self) -> float:
        """Time of a run of ICPSO over that of our noise-free fit, mean over the headings."""
        swarm = [f.seconds for f in self.off_centre(SwarmAlgorithm.ICPSO).values()]
        return float(np.mean(swarm) / np.mean([self.output_error[h].seconds for h in HEADINGS]))

    @property
    def simulation_ratio(self) -> float:
        """Return the records that a run of ICPSO simulates over those of our fit, least over the headings.

        An evaluation of ours simulates the record and its slope by each coefficient.
        """
        swarm = self.off_centre(SwarmAlgorithm.ICPSO)
        simulated = {h: self.output_error[h].evaluations * (1 + len(COEFFICIENTS)) for h in HEADINGS}
        return min(float(swarm[h].evaluations[0]) / simulated[h] for h in HEADINGS)


def error_text(searches: dict[int, RepeatedSearches]) -> str:
    """Mean errors at all headings."""
    return "/".join(f"{100.0 * float(np.mean(f.mean_error)):.1f}" for f in searches.values()) + " %"
