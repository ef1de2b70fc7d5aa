"""How a fit is made, with the defaults of the house. Defaults are frozen: never tuned for a ship."""

from dataclasses import dataclass, field
from enum import StrEnum

from seatrial.core.values import ForcePoints
from seatrial.estimation.problem.data_term import DataTerm

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


class FitCriterion(StrEnum):
    """What is minimised; `auto` is the decision table's choice."""

    AUTO = "auto"
    OUTPUT_ERROR = "output-error"
    MULTIPLE_SHOOTING = "multiple-shooting"
    PREDICTION_ERROR = "prediction-error"


class IntervalMethod(StrEnum):
    """Where intervals come from; `auto` is the decision table's choice."""

    AUTO = "auto"
    JACKKNIFE = "jackknife"
    BOOTSTRAP = "bootstrap"
    PROFILE = "profile"


@dataclass(frozen=True)
class Settings:
    """Choices of one fit; None means: the decision table decides.

    Attributes:
        criterion: what is minimised.
        segment_seconds: length of multiple-shooting segments; None: 1.5 L/U.
        channels: observables that are compared; empty: all that the records hold.
        robust: whether the loss is Huber's.
        noise: known standard deviations by channel, SI; others are estimated.
        corrections: nuisances estimated once a session: (input, kind, prior standard deviation SI, unit).
        current: whether a uniform current is estimated for each run, prior standard deviation in m/s (0: no).
        substeps: Runge-Kutta steps in one sample.
        evaluations: limit for each search.
        forces: tables of static force points that are fitted beside the records.
        others: other data beside the records: information carried from records no longer kept.
        intervals: where intervals come from; seed: of what is drawn for them.
    """

    criterion: FitCriterion = FitCriterion.AUTO
    segment_seconds: float | None = None
    channels: tuple[str, ...] = ()
    robust: bool = False
    noise: dict[str, float] = field(default_factory=dict)
    corrections: tuple[tuple[str, str, float, str], ...] = ()
    current: float = 0.0
    substeps: int = 1
    evaluations: int = 60
    workers: int | None = None
    forces: tuple[ForcePoints, ...] = ()
    extra_terms: tuple[DataTerm, ...] = ()
    intervals: IntervalMethod = IntervalMethod.AUTO
    seed: int = 0
