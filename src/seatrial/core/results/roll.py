"""What an identified roll model says in the field's terms: period, damping, metacentric height, each with its range."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number


@dataclass(frozen=True)
class IntervalEstimate:
    """A derived value with its 95 % interval, SI."""

    value: Number
    lower: Number
    upper: Number

    def scaled(self, factor: float) -> "IntervalEstimate":
        """Return it in another unit, or at another scale."""
        return IntervalEstimate(factor * self.value, factor * self.lower, factor * self.upper)


@dataclass(frozen=True)
class RollCharacteristics:
    """Roll as it follows from the coefficients, at rest and over the amplitude of a swing; bands at 95 %."""

    natural_period: Annotated[IntervalEstimate, Field(description="s, at small angles")]
    damping_ratio: Annotated[
        IntervalEstimate, Field(description="linear damping over critical damping, b_1 / (2 sqrt(c_1))")
    ]
    gyradius: Annotated[
        IntervalEstimate | None, Field(description="m, in roll with added inertia, given or assumed; null: not known")
    ]
    gyradius_source: Annotated[str, Field(description="where the gyradius comes from")]
    metacentric_height: Annotated[
        IntervalEstimate | None,
        Field(description="m; its range is the coefficients' interval and the full range of the gyradius"),
    ]
    amplitude: Annotated[tuple[Number, ...], Field(description="rad, up to the largest recorded")]
    damping: Annotated[tuple[Number, ...], Field(description="1/s, equivalent linear damping b_e over amplitude")]
    damping_lower: tuple[Number, ...]
    damping_upper: tuple[Number, ...]
    period: Annotated[tuple[Number, ...], Field(description="s, of a swing over amplitude")]
    period_lower: tuple[Number, ...]
    period_upper: tuple[Number, ...]
    swings: Annotated[
        tuple[tuple[Number, Number, Number], ...],
        Field(
            description="amplitude [rad], logarithmic damping [1/s], period [s] of each recorded swing, without any "
            "model; empty where the roll was excited"
        ),
    ] = ()
    spectrum: Annotated[
        tuple[tuple[Number, Number, Number], ...],
        Field(
            description="in waves that were not measured: frequency [rad/s], recorded (smoothed) and expected density "
            "of roll [rad^2 s/rad]; curves over amplitude are empty then"
        ),
    ] = ()
