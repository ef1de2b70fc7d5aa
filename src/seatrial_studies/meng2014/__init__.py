"""Meng et al. 2014: cloud particle swarm for heave and pitch with a fin, repeated with what our copy lacks assumed."""

import time

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter
from seatrial_studies.heave_pitch_search import output_error_results
from seatrial_studies.meng2014.facts import FACTS
from seatrial_studies.meng2014.reproduction import (
    HEADINGS,
    CloudSwarmEvidence,
    cloud_weight,
    controllers,
    off_centre_boxes,
    reproduce_searches,
    twelve_unknowns,
    undetected_change,
)
from seatrial_studies.study_page import study_from


def study(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> Study:
    """ICPSO and plain PSO at five headings; our fit on the same records; the twelve unknowns of the print.

    Args:
        quick: three runs of 400 iterations instead of five of 1000.
        seed: of seas, fin, noise, boxes and searches.
    """
    began = time.perf_counter()
    report = report_progress or (lambda _: None)
    reproduction = reproduce_searches(quick=quick, seed=seed, report_progress=report)
    report("our own fits, unknowns, and the cloud's weight")
    fits = {h: output_error_results(reproduction.seas[h], seed) for h in HEADINGS}
    first = [(seas[0], off_centre_boxes(seas, seed)[0]) for seas in reproduction.seas.values()]
    weight = cloud_weight(first, reproduction.iterations, seed)
    unknowns, change = twelve_unknowns(seed), undetected_change(reproduction.seas[135][0])
    report("controllers tuned on each method's coefficients")
    costs = controllers(reproduction, fits, seed)
    evidence = CloudSwarmEvidence(reproduction, fits, unknowns, change, weight, costs)
    return study_from("meng2014", FACTS, evidence, seed=seed, began=began)
