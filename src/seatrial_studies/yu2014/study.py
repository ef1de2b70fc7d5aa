"""The study: the loop in both readings, table 1 beside ours, the published search over seeds, and what beats it."""

import time

import numpy as np

from seatrial.core.results import Study
from seatrial.core.values import Progress
from seatrial.core.values.versions import versions
from seatrial.physics.loops.fin import Preamplifier
from seatrial_studies.yu2014.audit import audit
from seatrial_studies.yu2014.better import CAP, best_of_three, richer, roll_and_rate_elsewhere
from seatrial_studies.yu2014.evidence import Evidence, at_table_1
from seatrial_studies.yu2014.figures import figures
from seatrial_studies.yu2014.fitted import fitted
from seatrial_studies.yu2014.histories import histories, variation_of_rms
from seatrial_studies.yu2014.published import SOURCE, TABLE_1
from seatrial_studies.yu2014.readings import calibrated, motion, performance
from seatrial_studies.yu2014.searches import QUICK_SEEDS, SEEDS, SETTINGS, in_time, searches
from seatrial_studies.yu2014.tables import tables
from seatrial_studies.yu2014.verdicts import checks, claims

QUESTION = "Does a genetic algorithm find the gains of a fin stabiliser that save most energy, and what beats them?"
RATES = np.linspace(0.5, 1.75, 11)


def study(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    """Every table and figure beside ours.

    Args:
        quick: 4 seeds of the search instead of 12, fewer points of the trade between roll and fin rate.
        seed: of the searches, the waves of the figures and the searches that beat the paper.
    """
    began = time.perf_counter()
    if progress:
        progress("the print, table 1")
    all_fitted = tuple(fitted(r, following_is_zero=zero) for r in Preamplifier for zero in (True, False))
    best = min(all_fitted, key=lambda f: f.error)
    if progress:
        progress("the published search")
    searched = tuple(searches(setting, QUICK_SEEDS if quick else SEEDS, seed) for setting in SETTINGS)
    if progress:
        progress("what beats it")
    generator = np.random.default_rng([seed, 7])
    three = {
        r: (best_of_three(r, CAP, generator), best_of_three(r, motion(performance(r)).peak, generator))
        for r in Preamplifier
    }
    seen = Evidence(
        audit(seed), {r: calibrated(r) for r in Preamplifier}, {r: at_table_1(r) for r in Preamplifier}, all_fitted,
        histories(best, seed), variation_of_rms(best.reading), searched, in_time(seed), three,
        {r: tuple(roll_and_rate_elsewhere(r, row, generator) for row in TABLE_1) for r in Preamplifier},
        richer(seed, RATES[1::4] if quick else RATES),
    )  # fmt: skip
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
