"""Yu et al. 2014: three gains of a fin stabiliser by a genetic algorithm."""

import time

import numpy as np

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter
from seatrial.physics.loops import Preamplifier
from seatrial_studies.study_file import study_setting
from seatrial_studies.study_page import study_from
from seatrial_studies.yu2014.audit import audit
from seatrial_studies.yu2014.facts import FACTS, FinGainEvidence, responses_at_table_1
from seatrial_studies.yu2014.published import (
    TABLE_1,
    calibrated_K_q,
    performance,
    regulator_settings,
    roll_response,
)
from seatrial_studies.yu2014.reproduction import compare_energy, fit_table_1, rms_variation, simulate_histories
from seatrial_studies.yu2014.searches import (
    MS_LIMIT,
    SEEDS,
    SETTINGS,
    compare_weights,
    design_five_gains,
    joint_optimum,
    least_ratio_in_row,
    optimise_three_gains,
    search_over_seeds,
    time_domain_search,
    time_domain_seconds,
)

RATES = np.linspace(*study_setting("yu2014", "rates", list).value)


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
    return study_from("yu2014", FACTS, evidence, seed=seed, began=began)


def _evidence(*, quick: bool, seed: int, report: ProgressReporter) -> FinGainEvidence:
    """All numbers of the study."""
    report("the print, table 1")
    fits = tuple(fit_table_1(r, following_is_zero=zero) for r in Preamplifier for zero in (True, False))
    best = min(fits, key=lambda f: f.log_error)
    report("energy, regulators")
    energies = tuple(compare_energy(fit) for fit in fits)
    regulators = {r: regulator_settings(r) for r in Preamplifier}
    report("the published search")
    searched = tuple(search_over_seeds(setting, SEEDS.in_version(quick=quick), seed) for setting in SETTINGS)
    report("the published search with fixed weights")
    weights = {r: compare_weights(r, seed) for r in Preamplifier}
    report("one search for all six conditions")
    joint = {r: joint_optimum(r, SEEDS.in_version(quick=True), seed) for r in Preamplifier}
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
        weights=weights,
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
