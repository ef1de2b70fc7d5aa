"""What identified models of roll, heave and pitch say in the field's terms, each value with its range."""

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
        IntervalEstimate | None,
        Field(description="m, in roll with added inertia, given, assumed or by GM; null: not known"),
    ]
    gyradius_source: Annotated[str, Field(description="what was given or assumed of gyradius and GM")]
    metacentric_height: Annotated[
        IntervalEstimate | None,
        Field(description="m; given, or the coefficients' interval and the full range of the gyradius"),
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

    def __post_init__(self) -> None:
        curves = ("damping", "damping_lower", "damping_upper", "period", "period_lower", "period_upper")
        for name in curves:
            if len(getattr(self, name)) != len(self.amplitude):
                raise ValueError(f"{name} has {len(getattr(self, name))} values over {len(self.amplitude)} amplitudes")


@dataclass(frozen=True)
class PointMotion:
    """Vertical motion at one place of the ship."""

    place: str
    x: Annotated[Number, Field(description="m forward of the origin")]
    significant_amplitude: Annotated[Number, Field(description="m")]
    rms_acceleration: Annotated[Number, Field(description="m/s^2")]
    sickness_incidence: Annotated[Number, Field(description="share of people sick within two hours, 0 to 1")]


@dataclass(frozen=True)
class Seakeeping:
    """Heave [up] and pitch [bow down] per wave at one speed and heading, and in a sea of one spectrum."""

    run: Annotated[str, Field(description="name of the run whose waves they are")]
    speed: Annotated[Number, Field(description="m/s")]
    heading: Annotated[Number, Field(description="degrees, 0 following, 180 head")]
    sea: Annotated[str, Field(description="the spectrum in a phrase")]
    omega: Annotated[tuple[Number, ...], Field(description="rad/s, of the wave")]
    omega_e: Annotated[
        tuple[Number, ...], Field(description="rad/s, of encounter, negative where the ship overtakes the wave")
    ]
    heave: Annotated[tuple[Number, ...], Field(description="m per m of wave")]
    heave_phase: Annotated[tuple[Number, ...], Field(description="degrees ahead of the crest at the origin")]
    pitch: Annotated[tuple[Number, ...], Field(description="rad per rad of wave slope")]
    pitch_phase: Annotated[tuple[Number, ...], Field(description="degrees ahead of the crest at the origin")]
    sea_density: Annotated[tuple[Number, ...], Field(description="m^2 s/rad over omega")]
    heave_density: Annotated[tuple[Number, ...], Field(description="m^2 s/rad over omega")]
    pitch_density: Annotated[tuple[Number, ...], Field(description="deg^2 s/rad over omega")]
    heave_significant: Annotated[Number, Field(description="amplitude, m")]
    pitch_significant: Annotated[Number, Field(description="amplitude, degrees")]
    zero_crossing_periods: Annotated[
        tuple[Number, Number], Field(description="mean zero crossing periods of heave and pitch, s")
    ]
    points: tuple[PointMotion, ...]
