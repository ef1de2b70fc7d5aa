"""Everything the tables, figures and verdicts of the study rest on."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise import Normaliser
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.audit import FinGainAudit
from seatrial_studies.yu2014.energy import EnergyComparison
from seatrial_studies.yu2014.histories import RollHistories
from seatrial_studies.yu2014.improved_gains import FiveGainDesign, ThreeGainOptimum
from seatrial_studies.yu2014.joint_search import JointOptimum
from seatrial_studies.yu2014.published import TABLE_1
from seatrial_studies.yu2014.published_loop import FinObjective, RollResponse, SeaCondition, performance, roll_response
from seatrial_studies.yu2014.regulators import RegulatorSetting
from seatrial_studies.yu2014.searches import FinGainSearches
from seatrial_studies.yu2014.table_1_fit import Table1Fit, best_fit_of
from seatrial_studies.yu2014.time_domain_search import TimeDomainSearch


@dataclass(frozen=True, eq=False)
class FinGainEvidence:
    """Numbers of one run of the study.

    Attributes:
        calibrated_K_q: by reading.
        table_1_responses: the GA's column at these, long-crested, by reading, in the table's order.
        table_1_fits: table 1 fitted, each reading in both senses of the heading.
        rms_variation: of the rms roll of one record of 1000 s, share.
        time_domain_seconds: CPU time [s] of one search with records in time, compiled and with scipy's lsim.
        ratios_elsewhere: for each row of table 1 the least that three gains can make of the larger of roll and fin-rate
            variance over the paper's, by reading.
        energy: W and estimates of losses in every row, best fit; fitted_energies: the same of each of `table_1_fits`.
        regulators: Gh and Gl as functions, by reading.
        joint_optima: one set of gains for all six conditions, by reading.
        time_domain: the search by records of 1000 s; None in the quick version.
        three_gain_optima: the best of three gains by reading, with Ms <= 2 and with the paper's own Ms.
    """

    audit: FinGainAudit
    calibrated_K_q: dict[Preamplifier, float]
    table_1_responses: dict[Preamplifier, tuple[RollResponse, ...]]
    table_1_fits: tuple[Table1Fit, ...]
    histories: RollHistories
    rms_variation: float
    searches: tuple[FinGainSearches, ...]
    time_domain_seconds: tuple[float, float]
    energy: tuple[EnergyComparison, ...]
    fitted_energies: tuple[tuple[EnergyComparison, ...], ...]
    regulators: dict[Preamplifier, tuple[RegulatorSetting, ...]]
    joint_optima: dict[Preamplifier, JointOptimum]
    time_domain: TimeDomainSearch | None
    three_gain_optima: dict[Preamplifier, tuple[ThreeGainOptimum, ThreeGainOptimum]]
    ratios_elsewhere: dict[Preamplifier, tuple[float, ...]]
    five_gain_design: FiveGainDesign

    def fit(self, preamplifier: Preamplifier) -> Table1Fit:
        """Return the fit in the sense of the heading with the smaller error."""
        return best_fit_of(self.table_1_fits, preamplifier)

    @property
    def best_fit(self) -> Table1Fit:
        """Return the better fit of both readings."""
        return min(self.table_1_fits, key=lambda f: f.log_error)

    @property
    def nearest_baseline(self) -> Table1Fit:
        """Return the fit that comes nearest to the traditional PID's column."""
        return min(self.table_1_fits, key=lambda f: f.baseline_log_error)

    def searches_with(
        self,
        preamplifier: Preamplifier,
        fin_objective: FinObjective = FinObjective.PRINTED,
        normaliser: Normaliser = Normaliser.MAX,
    ) -> FinGainSearches:
        """Return the searches of one setting."""
        wanted = (preamplifier, fin_objective, normaliser)
        return next(
            s
            for s in self.searches
            if (s.setting.preamplifier, s.setting.fin_objective, s.setting.normaliser) == wanted
        )

    @property
    def search_seconds(self) -> float:
        """Return the median CPU time [s] of one search with its front."""
        return float(np.median(np.concatenate([s.seconds for s in self.searches])))


def responses_at_table_1(preamplifier: Preamplifier) -> tuple[RollResponse, ...]:
    """Return the paper's gains at every row of table 1, long-crested."""
    return tuple(roll_response(performance(preamplifier, SeaCondition(row.speed, row.heading))) for row in TABLE_1)
