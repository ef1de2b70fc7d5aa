"""Manoeuvring characteristics for the wheelhouse: each number with its interval and what it rests on."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number, StoredRecord


class Basis(StrEnum):
    """What a number on a poster rests on."""

    MEASURED = "measured"
    PREDICTED = "predicted"
    EXTRAPOLATED = "extrapolated"


@dataclass(frozen=True)
class PosterQuantity:
    """One manoeuvring measure of a poster."""

    name: Annotated[str, Field(description="as in `predictions[].measures`; names end in _L, _deg or _s")]
    value: Annotated[Number, Field(description="at the scale of the trials")]
    lower: Annotated[
        Number | None, Field(description="95 % interval, of a measured value that of its reading; null: not determined")
    ]
    upper: Annotated[Number | None, Field(description="as `lower`")]
    basis: Annotated[
        Basis,
        Field(
            description="measured: in a run of the trials; predicted: by the model, within what the training runs "
            "cover; extrapolated: by the model beyond them, so that intervals are lower limits"
        ),
    ]
    is_determined: Annotated[bool, Field(description="false: the records leave the value open")] = True
    repeats: Annotated[
        tuple[Number, ...],
        Field(description="value of each measured run, of which `value` is the largest; empty: fewer than two runs"),
    ] = ()


@dataclass(frozen=True)
class MeasuredRun:
    """A run of the trials that shows a manoeuvre of a poster."""

    name: str
    current: Annotated[
        Number | None,
        Field(
            description="m/s at the scale of the trials: speed of the estimated current that its measures are "
            "corrected for; null: none was estimated, and its distances are over ground"
        ),
    ] = None


@dataclass(frozen=True, eq=False)
class PosterManoeuvre:
    """One manoeuvre of a poster."""

    manoeuvre: Annotated[str, Field(description="as `seatrial simulate` takes it")]
    quantities: tuple[PosterQuantity, ...]
    simulated: Annotated[tuple[StoredRecord, ...], Field(description="the model's run; empty: it has none")] = ()
    runs: Annotated[
        tuple[MeasuredRun, ...], Field(description="runs of the trials that show it; empty: none does")
    ] = ()
    note: Annotated[str, Field(description="why there are no values; empty where there are")] = ""


@dataclass(frozen=True, eq=False)
class Poster:
    """What a wheelhouse poster and a pilot card show (IMO A.601(15), appendices 1 and 2), as far as a fit knows it."""

    ship: str
    particulars: Annotated[dict[str, Number], Field(description="SI, at the scale of the trials")]
    scale: Annotated[Number, Field(description="full scale over that of the trials")]
    model: str
    approach_speed: Annotated[Number, Field(description="m/s at the scale of the trials")]
    rudder_deg: Annotated[Number, Field(description="angle of the turning circles")]
    manoeuvres: tuple[PosterManoeuvre, ...]
    rudder_rate: Annotated[
        Number, Field(description="rad/s at the scale of the trials: of the rudder in all manoeuvres; 0: not known")
    ] = 0.0
    rudder_rate_origin: Annotated[str, Field(description="where the rudder's rate is from")] = ""
    training_runs: tuple[str, ...] = ()
    intervals: Annotated[str, Field(description="method of the coefficients' intervals")] = ""
    has_scale_effects: Annotated[
        bool, Field(description="whether intervals hold what the scale of a model test leaves open")
    ] = False
    versions: Annotated[dict[str, str], Field(description="package -> version")] = field(default_factory=dict)
