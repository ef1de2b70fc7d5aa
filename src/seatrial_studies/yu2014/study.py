"""The study: the loop in both readings, table 1 beside ours, the published search over seeds, and what beats it."""

import time

import numpy as np

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter, versions
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.audit import audit
from seatrial_studies.yu2014.evidence import FinGainEvidence, responses_at_table_1
from seatrial_studies.yu2014.figures import figures
from seatrial_studies.yu2014.histories import rms_variation, simulate_histories
from seatrial_studies.yu2014.improved_gains import MS_LIMIT, design_five_gains, least_ratio_in_row, optimise_three_gains
from seatrial_studies.yu2014.published import SOURCE, TABLE_1
from seatrial_studies.yu2014.published_loop import calibrated_K_q, performance, roll_response
from seatrial_studies.yu2014.searches import QUICK_SEEDS, SEEDS, SETTINGS, search_over_seeds, time_domain_seconds
from seatrial_studies.yu2014.table_1_fit import fit_table_1
from seatrial_studies.yu2014.tables import tables
from seatrial_studies.yu2014.verdicts import checks, claims

QUESTION = "Does a genetic algorithm find the gains of a fin stabiliser that save most energy, and what beats them?"
# fin-rate variance allowed, over the paper's; our choice
RATES = np.linspace(0.5, 1.75, 11)


def study(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> Study:
    """Run the study: the paper's tables and figures, each compared with ours.

    Args:
        quick: 4 seeds of the search instead of 12, fewer points of the trade between roll and fin rate.
        seed: of the searches, the waves of the figures and the searches that beat the paper.
    """
    began = time.perf_counter()
    if report_progress:
        report_progress("the print, table 1")
    all_fitted = tuple(fit_table_1(r, following_is_zero=zero) for r in Preamplifier for zero in (True, False))
    best = min(all_fitted, key=lambda f: f.log_error)
    if report_progress:
        report_progress("the published search")
    searched = tuple(search_over_seeds(setting, QUICK_SEEDS if quick else SEEDS, seed) for setting in SETTINGS)
    if report_progress:
        report_progress("what beats it")
    generator = np.random.default_rng([seed, 7])
    three = {
        r: (
            optimise_three_gains(r, MS_LIMIT, generator),
            optimise_three_gains(r, roll_response(performance(r)).Ms, generator),
        )
        for r in Preamplifier
    }
    seen = FinGainEvidence(
        audit(seed),
        {r: calibrated_K_q(r) for r in Preamplifier},
        {r: responses_at_table_1(r) for r in Preamplifier},
        all_fitted,
        simulate_histories(best, seed),
        rms_variation(best.preamplifier),
        searched,
        time_domain_seconds(seed),
        three,
        {r: tuple(least_ratio_in_row(r, row, generator) for row in TABLE_1) for r in Preamplifier},
        design_five_gains(seed, RATES[1::4] if quick else RATES),
    )
    return Study(
        name="yu2014",
        source=SOURCE,
        title="Three gains of a fin stabiliser: a published genetic algorithm repeated",
        question=QUESTION,
        claims=claims(seen),
        checks=checks(seen),
        tables=tables(seen),
        figures=figures(seen),
        seed=seed,
        quick=quick,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )
