"""Gains proposed on board: the sea and the craft that the last minutes show, and the gains that fit both. SI."""

from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field, computed_field

from seatrial.core.results.fields import Number


@dataclass(frozen=True)
class Estimated:
    """A value with the ends of its 95 % interval."""

    value: Annotated[Number, Field(description="median")]
    lower: Number
    upper: Number


@dataclass(frozen=True)
class HeadingRange:
    """Headings to the waves between two ends, rad, 0 following, pi head."""

    lower: float
    upper: float
    probability: Annotated[float, Field(description="0 to 1")]


@dataclass(frozen=True)
class SeaEstimate:
    """The sea that the motions of a stretch show."""

    height: Annotated[Estimated, Field(description="significant wave height, m")]
    period: Annotated[Estimated, Field(description="peak period, s")]
    heading: Annotated[Estimated, Field(description="to the waves, rad, 0 following, pi head")]
    headings: Annotated[
        tuple[HeadingRange, ...],
        Field(description="the fewest headings that hold 95 %, the likeliest range first; several: it is ambiguous"),
    ]
    is_heading_determined: Annotated[bool, Field(description="one range, and a narrow one")]


@dataclass(frozen=True)
class CraftFactor:
    """One property of the craft over that of the loop file's model."""

    name: Annotated[str, Field(description="gain of the actuator's effect, natural frequency, damping")]
    factor: Estimated


@dataclass(frozen=True)
class GainMargins:
    """Margins of the proposed gains, over the draws of sea and craft that the stretch allows."""

    Ms: Annotated[Estimated, Field(description="the largest |S|")]
    gain_margin: Annotated[Estimated, Field(description="factor by which the loop gain may grow; null: any")]
    phase_margin: Annotated[Estimated, Field(description="rad; null: any")]
    delay_margin: Annotated[Estimated, Field(description="s of dead time until the loop is unstable; null: any")]
    reduction: Annotated[Estimated, Field(description="of the output's rms, 0 to 1")]
    saturation: Annotated[Estimated, Field(description="share of actuator amplitudes beyond the limit, 0 to 1")]
    stable_draws: int
    draws: int


@dataclass(frozen=True)
class Proposal:
    """What is proposed after a stretch of record: gains, or none and why. Nothing is ever set by it."""

    loop: Annotated[str, Field(description="name of the loop")]
    start: Annotated[Number, Field(description="s on the stream's clock, of the stretch it rests on")]
    stop: Annotated[Number, Field(description="s on the stream's clock")]
    gains: Annotated[dict[str, float], Field(description="name -> value; empty: none are proposed")]
    reasons: Annotated[tuple[str, ...], Field(description="why these gains, or why none, sentence by sentence")]
    gain_units: dict[str, str] = field(default_factory=dict)
    is_new: Annotated[bool, Field(description="whether the gains differ from those proposed before")] = False
    U: Annotated[Number, Field(description="m/s, mean of the stretch")] = float("nan")
    sea: Annotated[SeaEstimate | None, Field(description="null: none could be estimated")] = None
    craft: tuple[CraftFactor, ...] = ()
    margins: Annotated[GainMargins | None, Field(description="null: no gains are proposed")] = None

    @computed_field(description="whether gains are proposed")
    @property
    def has_gains(self) -> bool:
        """Return whether gains are proposed."""
        return bool(self.gains)
