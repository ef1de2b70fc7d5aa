"""KVLCC2 from zigzags: Alexandersson, Mao & Ringsberg 2022 repeated on the records they used."""

import time
from collections.abc import Callable
from dataclasses import replace

from seatrial.core.results import Study
from seatrial_studies.alexandersson2022.facts import FACTS
from seatrial_studies.alexandersson2022.reproduction import reproduce_benchmark
from seatrial_studies.packaged_trials import packaged_trial
from seatrial_studies.study_page import study_from


def study(*, quick: bool, seed: int, report_progress: Callable[[str], None] | None) -> Study:
    """Identify KVLCC2 from twelve HSVA zigzags, predict the thirteenth and the 35 deg turns; the paper beside it.

    Args:
        quick: leaves out the leave-one-run-out tables and the family of models.
        seed: of the draws behind intervals of predictions and the bands of windows.

    Raises:
        InputError: SEATRIAL_DATA does not lead to the records, or what `identify` raises.
    """
    began = time.perf_counter()
    trial = packaged_trial("kvlcc2_hsva.toml")
    # as in the paper, whose towing tank records the rudder on the clock of the motions
    trial = replace(trial, estimate=trial.estimate.with_known_timing(trial.model.input_names))
    made = reproduce_benchmark(trial, quick=quick, seed=seed, report_progress=report_progress)
    predictions = (made.fit.validation[0], *(run.prediction for run in made.left_out_runs))
    return study_from(
        "alexandersson2022", FACTS, made, seed=seed, began=began, predictions=predictions, findings=made.fit.findings
    )
