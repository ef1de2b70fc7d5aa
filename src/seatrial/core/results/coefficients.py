"""What a fit says of each parameter, how it was estimated, and which models it was compared with."""

from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field, PlainSerializer, WithJsonSchema

from seatrial.core.results.fields import ABSENT, Number


def _absent_unless_given(value: float | None) -> object:
    return ABSENT if value is None else value


@dataclass(frozen=True)
class Coefficient:
    """One parameter of the model after the fit, SI units; the interval is at 95 %."""

    name: str
    unit: Annotated[str, Field(description="SI; 1 for a number, in the prime system of the model's source")]
    estimate: Number
    standard_error: Annotated[Number | None, Field(description="null for a fixed parameter")]
    lower: Annotated[Number | None, Field(description="null for a fixed parameter")]
    upper: Annotated[Number | None, Field(description="null for a fixed parameter")]
    fixed: Annotated[bool, Field(description="whether it was held at its value")]
    truth: Annotated[
        float | None,
        PlainSerializer(_absent_unless_given),
        WithJsonSchema({"type": "number"}),
        Field(description="true value where the records are simulated; else absent"),
    ] = None
    prior_mean: Annotated[float | None, Field(description="null without a prior")] = None
    prior_standard_deviation: Annotated[float | None, Field(description="null without a prior")] = None
    source: Annotated[str, Field(description="where a fixed value or a prior comes from")] = ""
    meaning: Annotated[str, Field(description="one phrase, as the model gives it")] = ""
    latex: Annotated[str, Field(description="symbol in LaTeX, as the model gives it")] = ""


@dataclass(frozen=True)
class Offset:
    """One nuisance parameter of a run or session."""

    name: Annotated[str, Field(description="channel and kind, such as delta zero")]
    group: Annotated[str, Field(description="run or session it belongs to")]
    unit: Annotated[str, Field(description="SI")]
    estimate: Number
    standard_error: Number | None


@dataclass(frozen=True)
class Method:
    """What was used and why, in sentences a report prints."""

    criterion: Annotated[str, Field(description="criterion of the estimate")]
    start: Annotated[str, Field(description="where the search started")]
    intervals: Annotated[str, Field(description="method of the intervals")]
    reasons: Annotated[tuple[str, ...], Field(description="why these")] = ()
    settings: Annotated[dict[str, int | float | str], Field(description="name -> value used")] = field(
        default_factory=dict
    )


@dataclass(frozen=True)
class CandidateModel:
    """One model of the declared family, scored over complete runs left out."""

    name: Annotated[str, Field(description="structure, prior and segment length")]
    free_count: Annotated[int, Field(description="number of free coefficients")]
    heading_deg: Annotated[
        Number | None, Field(description="rms over windows of the runs left out, degrees; null: failed or no heading")
    ]
    position_m: Annotated[Number | None, Field(description="the same of the position, m")]
    is_tied: Annotated[bool, Field(description="not distinguishable from the best one by these runs")]
    is_chosen: bool = False
    note: Annotated[str, Field(description="why it failed; empty where it did not")] = ""
    roll_deg: Annotated[
        Number | None,
        Field(description="rms over complete runs left out, degrees; null: no ship that rolls about rest"),
    ] = None
