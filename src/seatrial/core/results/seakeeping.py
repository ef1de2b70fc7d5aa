"""What an identified ship does in the sea of its trial: response amplitude operators, spectra, statistics."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number


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
