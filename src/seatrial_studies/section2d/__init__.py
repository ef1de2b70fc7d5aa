"""A 2-D ship section in regular beam waves: heave, sway and roll from measured records, beside potential theory."""

import time

from seatrial.core.results import Study
from seatrial.core.values import ProgressReporter, versions
from seatrial_studies.section2d.analysis import analyse_records, instrument_findings
from seatrial_studies.section2d.responses import SOURCE, data_folder
from seatrial_studies.section2d.tables import figures, tables
from seatrial_studies.section2d.verdicts import checks, claims

QUESTION = (
    "What do measured motions of a ship section in regular beam waves show of added mass, damping, stiffness and "
    "excitation, and do they predict wave periods that were not used?"
)


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
    return Study(
        name="section2d",
        source=SOURCE,
        title="A ship section in regular beam waves: heave and roll from measured records",
        question=QUESTION,
        kind="Measured records worked through",
        claims=claims(made),
        checks=checks(made),
        tables=tables(made),
        figures=figures(made),
        findings=instrument_findings(made),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )
