"""What the records can tell, noise and family as entries of the JSON; numbers that are none become null."""

import math
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field


def finite(value: float | None) -> float | None:
    """The number, or None where JSON has none."""
    return None if value is None or not math.isfinite(value) else float(value)


Number = Annotated[float | None, BeforeValidator(finite)]


class Entry(BaseModel):
    """A table with these keys and no others; made from the value of the same attributes."""

    model_config = ConfigDict(extra="forbid", from_attributes=True)


class SymmetryEntry(Entry):
    """A change of parameters that no record of the compared outputs can show, whatever the manoeuvre."""

    parameters: list[str]
    text: str
    change: dict[str, Number] = Field(description="relative change for a unit step; absolute where the value is zero")


class DirectionEntry(Entry):
    """One direction of the free coefficients, weakest first."""

    combination: dict[str, Number] = Field(description="parts of a unit vector in relative changes, largest first")
    standard_deviation: Number = Field(description="of the relative change along it, 1: 100 %; null: not determined")
    text: str


class CollinearityEntry(Entry):
    """How far one coefficient can be taken for others."""

    parameter: str
    variance_inflation: Number = Field(description="null: without limit")
    partner: str
    correlation: Number


class SensitivityEntry(Entry):
    """Change of the compared outputs (rms, in units of their noise) for 10 % of a coefficient."""

    parameter: str
    effect: Number = Field(description="over all outputs together")
    outputs: dict[str, Number]


class ConsequenceEntry(Entry):
    """What a wrong assumed value would do."""

    parameter: str
    change: Number = Field(description="relative")
    estimate_changes: dict[str, Number] = Field(description="relative change of the estimates, largest first")
    misfit: Number = Field(description="increase of chi squared by which the records would show it")
    text: str


class StabilityEntry(Entry):
    """Course stability index C of a straight course, positive: stable; the interval is at 95 %."""

    index: Number
    lower: Number
    upper: Number
    text: str


class ProfileEntry(Entry):
    """Profile likelihood of one coefficient; SI."""

    parameter: str
    values: list[Number]
    costs: list[Number] = Field(description="twice the loss above its minimum; 3.84 bounds 95 %")
    lower: Number
    upper: Number


class IdentifiabilityEntry(Entry):
    """What the records can tell of the model and what they cannot."""

    structural: list[SymmetryEntry]
    directions: list[DirectionEntry]
    effective_parameters: Number = Field(description="number of coefficients that the data determine")
    condition: Number = Field(description="of the information matrix scaled to unit diagonal; null: singular")
    collinearity: list[CollinearityEntry]
    sensitivities: list[SensitivityEntry]
    consequences: list[ConsequenceEntry]
    stability: StabilityEntry | None
    profiles: list[ProfileEntry]


class NoiseEntry(Entry):
    """The criterion of the fit and the noise it allows for."""

    method: str = Field(description="output error or prediction error")
    whiteness_p: Number = Field(description="smallest p-value over the channels that the residuals are white")
    process: dict[str, Number] = Field(description="state -> intensity, SI unit of the state over the root of a second")
    measurement: dict[str, Number] = Field(description="channel -> standard deviation, SI")
    text: str


class PointMotionEntry(Entry):
    """Vertical motion at one place of the ship."""

    place: str
    x: Number = Field(description="m forward of the origin")
    significant_amplitude: Number = Field(description="amplitude, m")
    rms_acceleration: Number = Field(description="rms, m/s^2")
    sickness_incidence: Number = Field(description="share of people sick within two hours")


class SeakeepingEntry(Entry):
    """Heave [up] and pitch [bow down] per wave at the speed and heading of the trial, and in a sea."""

    run: str
    speed: Number = Field(description="m/s")
    heading: Number = Field(description="degrees, 0 following, 180 head")
    sea: str
    omega: list[Number] = Field(description="rad/s, of the wave")
    omega_e: list[Number] = Field(description="rad/s, of encounter, negative where the ship overtakes the wave")
    heave: list[Number] = Field(description="m per m of wave")
    heave_phase: list[Number] = Field(description="degrees ahead of the crest at the origin")
    pitch: list[Number] = Field(description="rad per rad of wave slope")
    pitch_phase: list[Number]
    sea_density: list[Number] = Field(description="m^2 s/rad over omega")
    heave_density: list[Number] = Field(description="m^2 s/rad over omega")
    pitch_density: list[Number] = Field(description="deg^2 s/rad over omega")
    heave_significant: Number = Field(description="amplitude, m")
    pitch_significant: Number = Field(description="amplitude, degrees")
    zero_crossing_periods: list[Number] = Field(description="mean zero crossing of heave and pitch, s")
    points: list[PointMotionEntry]


class EstimatedEntry(Entry):
    """A derived value with its 95 % interval, SI."""

    value: Number
    lower: Number
    upper: Number


class RollingEntry(Entry):
    """Roll as it follows from the coefficients, at rest and over the amplitude of a swing; bands at 95 %."""

    natural_period: EstimatedEntry = Field(description="s, at small angles")
    damping_ratio: EstimatedEntry = Field(description="linear damping over critical damping, 1")
    gyradius: EstimatedEntry | None = Field(description="m, in roll with added inertia, given or assumed")
    gyradius_source: str = Field(description="where the gyradius comes from")
    metacentric_height: EstimatedEntry | None = Field(description="m, range with that of the gyradius")
    amplitude: list[Number] = Field(description="rad")
    damping: list[Number] = Field(description="equivalent linear damping over amplitude, 1/s")
    damping_lower: list[Number]
    damping_upper: list[Number]
    period: list[Number] = Field(description="of a swing over amplitude, s")
    period_lower: list[Number]
    period_upper: list[Number]
    swings: list[tuple[Number, Number, Number]] = Field(
        description="amplitude, logarithmic damping, period of each recorded swing of a decay, without any model"
    )
    spectrum: list[tuple[Number, Number, Number]] = Field(
        description="in waves nobody measured: frequency, recorded and expected density of roll, rad^2 s/rad"
    )


class FindingEntry(Entry):
    """Something a check or an estimate has to say."""

    severity: str = Field(pattern="^(info|warning|error)$")
    code: str
    text: str
    advice: str


class SailedEntry(Entry):
    """Runs simulated open loop, together; rms and correlation are empty where one diverges."""

    rms: dict[str, Number] = Field(description="keys as in validation, root mean square over the runs")
    correlation: dict[str, Number] = Field(description="u, v, r: Pearson's coefficient, mean over the runs")
    diverged: list[str] = Field(description="names of the runs whose simulation diverges")


class RivalEntry(Entry):
    """An estimator on the same training runs; first the fit itself, as it stands and without offsets."""

    name: str
    values: dict[str, Number] = Field(description="SI; empty where the estimator failed")
    normalised_difference: dict[str, Number] = Field(
        description="difference from the fit's estimates in their standard errors"
    )
    error: dict[str, Number] = Field(description="relative, where the true value is known and not zero")
    training: SailedEntry
    validation: SailedEntry
    bias: dict[str, Number] = Field(description="equations -> constant the estimator allowed itself besides")
    findings: list[FindingEntry]
    note: str = Field(description="why the estimator failed; empty where it did not")
    is_fit: bool = Field(description="whether these are the coefficients of the fit")


class FamilyEntry(Entry):
    """One model of the family, scored over whole runs left out."""

    name: str
    free_count: int
    heading_deg: Number = Field(description="rms, null where the fit failed")
    position_m: Number
    roll_deg: Number = Field(description="rms over whole runs, of a ship that swings about a rest; else null")
    is_tied: bool = Field(description="not told from the best one by its runs")
    is_chosen: bool
    note: str
