"""Qi et al. 2025: improved wild horse optimizer for heave and pitch, repeated as published, audited, and answered."""

import time

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter
from seatrial_studies.heave_pitch_search import output_error_results
from seatrial_studies.qi2025.evidence import WildHorseEvidence, centre_bias, controllers, hold_bias, track
from seatrial_studies.qi2025.facts import FACTS
from seatrial_studies.qi2025.published import audit
from seatrial_studies.qi2025.reproduction import (
    FIGURE_HEADING,
    PART_RUNS,
    ablation,
    reproduce_searches,
)
from seatrial_studies.seaway import HEADINGS
from seatrial_studies.study_page import study_from


def study(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> Study:
    """PSO, WHO and IWHO at 90, 135 and 180 degrees as published and otherwise; the print audited; our fit beside it.

    Args:
        quick: leaves out the settings that no claim rests on, and runs fewer searches.
        seed: of seas, boxes and searches.
    """
    began = time.perf_counter()
    report = report_progress or (lambda _: None)
    reproduction = reproduce_searches(quick=quick, seed=seed, report_progress=report)
    report("IWHO with parts left out")
    ablated = ablation(reproduction, seed, PART_RUNS.in_version(quick=quick))
    report("audit and our own fits")
    fits = {h: output_error_results(reproduction.seas[h], seed) for h in HEADINGS}
    audited, held, centred = (
        audit(reproduction.seas[FIGURE_HEADING], seed), hold_bias(seed), centre_bias(reproduction.seas, seed),
    )  # fmt: skip
    report("controllers tuned on each method's coefficients")
    evidence = WildHorseEvidence(
        reproduction, audited, fits, held, centred, track(reproduction, seed), ablated,
        controllers(reproduction, fits, seed),
    )  # fmt: skip
    return study_from("qi2025", FACTS, evidence, seed=seed, began=began)
