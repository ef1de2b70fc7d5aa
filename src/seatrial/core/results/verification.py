"""A controller after its trial at sea: what was predicted beside what was achieved, and what in the model was wrong."""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.fields import ListedArray, Number, ReportedFinding, StoredArray, Summarised, Summary


@dataclass(frozen=True)
class VerifiedQuantity:
    """One quantity, predicted and achieved, each with its 95 % interval."""

    name: str
    unit: Annotated[str, Field(description="SI; 1/h for reversals")]
    predicted: Annotated[Number, Field(description="by the model as it was, in what was met at sea")]
    predicted_lower: Number
    predicted_upper: Number
    achieved: Annotated[Number, Field(description="by the log")]
    lower: Annotated[
        Number, Field(description="of what was achieved; null: the interval of the prediction has what chance does")
    ]
    upper: Annotated[Number, Field(description="as `lower`")]
    is_inside: Annotated[
        bool,
        Field(
            description="whether the 95 % interval of the difference, errors of both in it, includes zero; where what "
            "was achieved has no interval, whether it lies in that of the prediction"
        ),
    ]


@dataclass(frozen=True)
class ReductionEstimate:
    """The reduction of the output's rms by one way to correct for the sea, with its 95 % interval."""

    method: Annotated[str, Field(description="in words")]
    value: Annotated[Number, Field(description="0 to 1")]
    lower: Number
    upper: Number


@dataclass(frozen=True)
class ModelCorrection:
    """One property of the plant as the model has it and as the log shows it."""

    name: str
    unit: str
    model: Annotated[Number, Field(description="before the log")]
    deviation: Annotated[Number, Field(description="standard deviation before the log")]
    log: Annotated[Number, Field(description="with the log, what was known before as prior")]
    lower: Annotated[Number, Field(description="95 % interval with the log")]
    upper: Number
    is_moved: Annotated[
        bool, Field(description="whether errors of both do not explain the change, all coefficients together")
    ]


@dataclass(frozen=True, eq=False)
class VerifiedLeg:
    """A stretch with the controller on or off, in waves; spectra over the frequency of encounter."""

    record: Annotated[str, Field(description="name of the record")]
    start: Annotated[float, Field(description="s on the record's clock")]
    stop: Annotated[float, Field(description="s on the record's clock")]
    is_controlled: bool
    U: Annotated[float, Field(description="m/s")]
    height: Annotated[Number, Field(description="significant height of the sea that explains the leg, m")]
    height_lower: Annotated[Number, Field(description="95 % interval")]
    height_upper: Number
    period: Annotated[Number, Field(description="peak period of that sea, s")]
    period_lower: Annotated[Number, Field(description="95 % interval")]
    period_upper: Number
    output_rms: Annotated[Number, Field(description="SI")]
    actuator_rms: Annotated[Number, Field(description="SI")]
    gain_ratio: Annotated[
        Number, Field(description="what the actuator did over what the gains order of the output; null: off")
    ] = float("nan")
    correlation: Annotated[Number, Field(description="coherence of both, 0 to 1; null: off")] = float("nan")
    omega: Annotated[ListedArray, Field(description="rad/s, shape (k,)")] = field(default_factory=lambda: np.empty(0))
    measured: Annotated[ListedArray, Field(description="density of the output, SI^2 s/rad, shape (k,)")] = field(
        default_factory=lambda: np.empty(0)
    )
    predicted: Annotated[
        ListedArray, Field(description="of the output by the model as it was, in the sea met, shape (k,)")
    ] = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, eq=False)
class VerifiedChange:
    """One change of an ordered output; series about what was held before, SI, shape (n,)."""

    record: Annotated[str, Field(description="name of the record")]
    start: Annotated[float, Field(description="s on the record's clock")]
    change: Annotated[float, Field(description="of the order, SI")]
    predicted_overshoot: Annotated[Number, Field(description="share of the change, by the model without weather")]
    overshoot: Annotated[Number, Field(description="share of the change")]
    predicted_settling: Annotated[Number, Field(description="s until the output stays within 5 %, without weather")]
    settling: Annotated[Number, Field(description="s until the output stays within 5 %; the leg's length: never")]
    output: Annotated[str, Field(description="symbol")]
    actuator: Annotated[str, Field(description="symbol")]
    dt: Annotated[float, Field(description="s between two samples")]
    order: StoredArray
    measured: Annotated[StoredArray, Field(description="the output")]
    predicted: Annotated[StoredArray, Field(description="the output by the model, without weather")]
    moved: Annotated[StoredArray, Field(description="the actuator")]
    predicted_moved: Annotated[StoredArray, Field(description="the actuator by the model, without weather")]


@dataclass(frozen=True, eq=False, repr=False)
class Verification(Summarised):
    """What the log of a trial says of a tuned controller."""

    name: str
    plant: Annotated[str, Field(description="where it comes from, in a sentence")]
    output: Annotated[str, Field(description="symbol of what is to stay small")]
    actuator: Annotated[str, Field(description="symbol of what moves")]
    gains: Annotated[dict[str, float], Field(description="name -> value, those that were on")]
    legs: Annotated[tuple[VerifiedLeg, ...], Field(description="in order of time")]
    quantities: Annotated[tuple[VerifiedQuantity, ...], Field(description="of all legs with control together")]
    reductions: Annotated[tuple[ReductionEstimate, ...], Field(description="the first is that of `quantities`")]
    corrections: tuple[ModelCorrection, ...]
    findings: tuple[ReportedFinding, ...]
    versions: Annotated[dict[str, str], Field(description="package -> version")] = field(default_factory=dict)
    changes: Annotated[tuple[VerifiedChange, ...], Field(description="of a loop that follows a demand")] = ()

    @computed_field(description="names of the quantities that lie outside what was predicted")
    @property
    def outside(self) -> tuple[str, ...]:
        """Return the names of the quantities that lie outside what was predicted."""
        return tuple(q.name for q in self.quantities if not q.is_inside)

    @computed_field(description="names of the properties of the model that the log moves beyond its interval")
    @property
    def moved(self) -> tuple[str, ...]:
        """Return the names of the properties of the model that the log moves beyond its interval."""
        return tuple(c.name for c in self.corrections if c.is_moved)

    def summary(self) -> Summary:
        """Return predicted and achieved values as a table."""
        rows = tuple(
            (q.name, q.unit, *(f"{v:.4g}" for v in (q.predicted, q.achieved, q.lower, q.upper)),
             "inside" if q.is_inside else "outside")
            for q in self.quantities
        )  # fmt: skip
        header = ("quantity", "unit", "predicted", "achieved", "lower 95 %", "upper 95 %", "")
        facts = {"controller": self.name, "model": ", ".join(self.moved) or "as it was"}
        return Summary(f"Verification of {self.name}", header, rows, facts, ())


def normal_interval(value: float, deviation: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a normal estimate."""
    return value - NORMAL_95 * deviation, value + NORMAL_95 * deviation


def is_consistent(first: float, second: float, first_deviation: float, second_deviation: float) -> bool:
    """Return whether the 95 % interval of the difference of two normal estimates includes zero."""
    return bool(abs(first - second) <= NORMAL_95 * np.hypot(first_deviation, second_deviation))


NORMAL_95 = 1.959964
"""Standard deviations to either side that hold 95 % of a normal distribution."""
