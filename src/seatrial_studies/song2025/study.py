"""The study: the pipeline as published, its print audited, where its errors come from, and what beats it."""

import time

from seatrial.core.results import Study
from seatrial.core.values import Progress
from seatrial.core.values.versions import versions
from seatrial.estimation.information.sensitivity import indirect, unique
from seatrial_studies.song2025.audit import audit
from seatrial_studies.song2025.choices import choices
from seatrial_studies.song2025.crafts import MENDED, TRUTH, reference
from seatrial_studies.song2025.discrimination import discrimination
from seatrial_studies.song2025.evidence import Evidence
from seatrial_studies.song2025.figures import figures, predictions
from seatrial_studies.song2025.generalisation import outcome, steady_drift
from seatrial_studies.song2025.published import SOURCE, Run
from seatrial_studies.song2025.repetition import repetition
from seatrial_studies.song2025.tables import tables
from seatrial_studies.song2025.verdicts import checks, claims

QUESTION = "Do support vectors identify the coefficients of a waterjet craft from zigzags, and what does better?"
TURN = 35.0


def study(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    """Every table and figure beside ours.

    Args:
        quick: fewer settings of the support vectors, noise levels, and other choices of what is not printed.
        seed: of the sensors' noise and of the shuffled split.
    """
    began = time.perf_counter()
    made = repetition(quick=quick, seed=seed, progress=progress)
    if progress:
        progress("the print")
    audited = audit(choices()[: 1 if quick else None])
    _, original, improved = MENDED
    runs = (Run.CONSECUTIVE, Run.ZIGZAG_20, Run.ZIGZAG_35, Run.TURN_35)
    seen = Evidence(
        made,
        audited,
        (
            *(outcome(improved, run, reference(run)) for run in runs),
            outcome(original, Run.ZIGZAG_20, reference(Run.ZIGZAG_20)),
        ),
        discrimination(made.series),
        indirect(TRUTH.craft(), made.series),
        unique(TRUTH.craft(), made.series),
        (steady_drift(TRUTH, TURN), steady_drift(improved, TURN)),
    )
    return Study(
        name="song2025",
        source=SOURCE,
        title="Support vectors and the coefficients of a waterjet craft: a published pipeline repeated",
        question=QUESTION,
        claims=claims(seen),
        checks=checks(seen),
        tables=tables(seen),
        figures=figures(seen),
        predictions=predictions(seen),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )
