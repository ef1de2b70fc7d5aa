"""The study: the loop in both readings, table 1 beside ours, the published search over seeds, and what beats it."""

import time

import numpy as np

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter, versions
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.audit import audit
from seatrial_studies.yu2014.energy import compare_energy
from seatrial_studies.yu2014.evidence import FinGainEvidence, responses_at_table_1
from seatrial_studies.yu2014.figures import figures
from seatrial_studies.yu2014.histories import rms_variation, simulate_histories
from seatrial_studies.yu2014.improved_gains import MS_LIMIT, design_five_gains, least_ratio_in_row, optimise_three_gains
from seatrial_studies.yu2014.joint_search import joint_optimum
from seatrial_studies.yu2014.published import SOURCE, TABLE_1
from seatrial_studies.yu2014.published_loop import calibrated_K_q, performance, roll_response
from seatrial_studies.yu2014.regulators import regulator_settings
from seatrial_studies.yu2014.searches import QUICK_SEEDS, SEEDS, SETTINGS, search_over_seeds, time_domain_seconds
from seatrial_studies.yu2014.table_1_fit import fit_table_1
from seatrial_studies.yu2014.tables import tables
from seatrial_studies.yu2014.time_domain_search import time_domain_search
from seatrial_studies.yu2014.verdicts import checks, claims

QUESTION = "Does a genetic algorithm find the gains of a fin stabiliser that save most energy, and what beats them?"
# fin-rate variance allowed, over the paper's; our choice
RATES = np.linspace(0.5, 1.75, 11)


def study(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> Study:
    """Run the study: the paper's tables and figures, each compared with ours.

    Args:
        quick: 4 seeds of the search instead of 12, fewer points of the trade between roll and fin rate, no search by
            records of 1000 s.
        seed: of the searches, the waves of the figures and the searches that beat the paper.
    """
    began = time.perf_counter()
    report = report_progress or (lambda _: None)
    evidence = _evidence(quick=quick, seed=seed, report=report)
    return Study(
        name="yu2014",
        source=SOURCE,
        title="Three gains of a fin stabiliser: a published genetic algorithm repeated",
        question=QUESTION,
        claims=claims(evidence),
        checks=checks(evidence),
        tables=tables(evidence),
        figures=figures(evidence),
        seed=seed,
        quick=quick,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )


def _evidence(*, quick: bool, seed: int, report: ProgressReporter) -> FinGainEvidence:
    """All numbers of the study."""
    report("the print, table 1")
    fits = tuple(fit_table_1(r, following_is_zero=zero) for r in Preamplifier for zero in (True, False))
    best = min(fits, key=lambda f: f.log_error)
    report("energy, regulators")
    energies = tuple(compare_energy(fit) for fit in fits)
    regulators = {r: regulator_settings(r) for r in Preamplifier}
    report("the published search")
    searched = tuple(search_over_seeds(setting, QUICK_SEEDS if quick else SEEDS, seed) for setting in SETTINGS)
    report("one search for all six conditions")
    joint = {r: joint_optimum(r, QUICK_SEEDS, seed) for r in Preamplifier}
    if not quick:
        report("the search by 10,000 records of 1000 s, once")
    by_records = None if quick else time_domain_search(Preamplifier.WASHOUT, seed)
    report("what beats it: three gains")
    generator = np.random.default_rng([seed, 7])
    three = {
        r: (
            optimise_three_gains(r, MS_LIMIT, generator),
            optimise_three_gains(r, roll_response(performance(r)).Ms, generator),
        )
        for r in Preamplifier
    }
    elsewhere = {r: tuple(least_ratio_in_row(r, row, generator) for row in TABLE_1) for r in Preamplifier}
    report("what beats it: five gains")
    return FinGainEvidence(
        audit=audit(seed),
        calibrated_K_q={r: calibrated_K_q(r) for r in Preamplifier},
        table_1_responses={r: responses_at_table_1(r) for r in Preamplifier},
        table_1_fits=fits,
        histories=simulate_histories(best, seed),
        rms_variation=rms_variation(best.preamplifier),
        searches=searched,
        time_domain_seconds=time_domain_seconds(seed),
        energy=energies[fits.index(best)],
        fitted_energies=energies,
        regulators=regulators,
        joint_optima=joint,
        time_domain=by_records,
        three_gain_optima=three,
        ratios_elsewhere=elsewhere,
        five_gain_design=design_five_gains(seed, RATES[1::4] if quick else RATES),
    )
