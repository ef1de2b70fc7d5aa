"""Song et al. 2025: support vector regression for a waterjet craft, repeated as published, audited, and answered."""

import time

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter
from seatrial_studies.song2025.audit import assumed_parameter_sets, audit
from seatrial_studies.song2025.facts import FACTS, SupportVectorEvidence, predictions
from seatrial_studies.song2025.generalisation import (
    SPEED_FACTORS,
    compare_craft,
    compare_run,
    discrimination,
    heading_controller_costs,
    indirect_sensitivity,
    speed_predictions,
    steady_drift_angle,
    unique_sensitivity,
)
from seatrial_studies.song2025.published import CORRECTED, TRUTH, PublishedManoeuvre, reference_record
from seatrial_studies.song2025.reproduction import cleaning_ablation, reproduce_regressions
from seatrial_studies.study_page import study_from

RUNS = (
    PublishedManoeuvre.CONSECUTIVE,
    PublishedManoeuvre.ZIGZAG_20,
    PublishedManoeuvre.ZIGZAG_35,
    PublishedManoeuvre.TURN_35,
)
# name of our own coefficients in tables and figures
OWN = "our improved pipeline"
# deg, nozzle angle of the paper's turn
TURN_ANGLE = 35.0


def study(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> Study:
    """Run the study: the paper's tables and figures, each compared with ours.

    Args:
        quick: fewer settings of the support vectors, noise levels, and other choices of what is not printed.
        seed: of the sensors' noise and of the shuffled split.
    """
    began = time.perf_counter()
    report = report_progress or (lambda _: None)
    made = reproduce_regressions(quick=quick, seed=seed, report_progress=report)
    report("the print")
    audited = audit(assumed_parameter_sets()[: 1 if quick else None])
    _, original, improved = CORRECTED
    report("our own coefficients simulated")
    own = made.published[1].craft
    own_runs = tuple(compare_craft(OWN, own, run, reference_record(run)) for run in RUNS)
    report("steps left out, bad data planted")
    ablation = cleaning_ablation(made.series, quick=quick, seed=seed)
    report("other speeds, and controllers tuned on each method's coefficients")
    crafts = {"the paper's improved column, corrected": improved.craft(), OWN: own}
    costs = {"the paper's original column, N_v corrected": original.craft(), **crafts,
             "output error, sensor noise": made.output_error_noisy.craft}  # fmt: skip
    evidence = SupportVectorEvidence(
        made,
        audited,
        (
            *(compare_run(improved, run, reference_record(run)) for run in RUNS),
            compare_run(original, PublishedManoeuvre.ZIGZAG_20, reference_record(PublishedManoeuvre.ZIGZAG_20)),
        ),
        discrimination(made.series),
        indirect_sensitivity(TRUTH.craft(), made.series),
        unique_sensitivity(TRUTH.craft(), made.series),
        (steady_drift_angle(TRUTH, TURN_ANGLE), steady_drift_angle(improved, TURN_ANGLE)),
        own_runs,
        ablation,
        speed_predictions(crafts, SPEED_FACTORS),
        heading_controller_costs(costs),
    )
    return study_from("song2025", FACTS, evidence, seed=seed, began=began, predictions=predictions(evidence))
