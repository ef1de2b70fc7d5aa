"""A 2-D ship section in regular beam waves: heave, sway and roll from measured records, beside potential theory."""

import time

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter
from seatrial_studies.section2d.analysis import analyse_records, instrument_findings
from seatrial_studies.section2d.facts import FACTS
from seatrial_studies.section2d.responses import data_folder
from seatrial_studies.study_page import study_from


def study(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> Study:
    """Heave from the sway-heave runs, roll from the heave-roll runs, the coupled runs reported.

    Args:
        quick: leaves out what other choices of the steady stretch would have given.
        seed: nothing is random here; kept for the page.

    Raises:
        InputError: SEATRIAL_DATA does not lead to the records, or they do not suffice.
    """
    began = time.perf_counter()
    made = analyse_records(data_folder(), quick=quick, report_progress=report_progress)
    return study_from("section2d", FACTS, made, seed=seed, began=began, findings=instrument_findings(made))
