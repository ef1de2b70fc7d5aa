"""Constants of the decision table, and what one estimate needs that no trial file sets."""

from dataclasses import dataclass
from enum import StrEnum

SEGMENT_SHIP_LENGTHS = 1.5
"""Length of a multiple-shooting segment, in ship lengths travelled (1.5 L/U)."""

WEAK_FORM_SHIP_LENGTHS = 1.5
"""Half width of the weak form's windows, in ship lengths travelled."""

HUBER_LIMIT = 3.0
"""Residuals beyond this many standard deviations count linearly where the loss is robust."""

WHITE_INFLATION = 1.3
"""Residuals whose correlation inflates the variance of a mean by less than this count as white."""

INITIAL_STATE_SHIP_LENGTHS = 1.0
"""The initial state of a validation run comes from its first L/U seconds."""

JUDGED_SHIP_LENGTHS = 5.0
"""Criteria are judged in windows of 5 L/U, besides whole quarters of runs; chosen."""


class IntervalMethod(StrEnum):
    """Where intervals come from; `auto` is the decision table's choice."""

    AUTO = "auto"
    JACKKNIFE = "jackknife"
    BOOTSTRAP = "bootstrap"
    PROFILE = "profile"
    SAMPLING = "sampling"


@dataclass(frozen=True)
class EstimatorOptions:
    """How one estimate is computed.

    Attributes:
        intervals: where intervals come from; seed: of what is drawn for them.
        evaluations: limit of each search.
        workers: threads; None: one for each core.
        windows: in which validation runs are predicted as well, as ``10s,5L``; empty: by the length of the run.
        horizons: of the k-step errors, samples or seconds, as ``1,10,5s``; empty: by the length of the runs.
    """

    intervals: IntervalMethod = IntervalMethod.AUTO
    seed: int = 0
    evaluations: int = 60
    workers: int | None = None
    windows: str = ""
    horizons: str = ""
