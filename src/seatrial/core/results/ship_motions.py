"""What identified models say in the terms of those who steer: roll, heave, pitch, responses, thrusters."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from seatrial.core.results.fields import ComplexArray, ListedArray, Number

# The response of an output to an input over frequency: the records' and the model's, estimated in one way.

Mask = NDArray[np.bool_]
"""Booleans, one for each frequency."""


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Cross-spectrum over input spectrum (H1), of what was measured and of the model simulated with the same inputs.

    Both have the same windows, the same transients and, where several inputs move, the same share of the others; so
    they may be compared with each other, also for a nonlinear model, but are no transfer function then.
    """

    input: str
    output: str
    unit: Annotated[str, Field(description="SI unit of the output over that of the input")]
    omega: Annotated[ListedArray, Field(description="rad/s, shape (n,)")]
    measured: Annotated[ComplexArray, Field(description="response of the records")]
    simulated: Annotated[ComplexArray, Field(description="response of the model over the same runs")]
    coherence: Annotated[
        ListedArray, Field(description="share of the measured output's power that is linear in the input, 0 to 1")
    ]
    radius: Annotated[
        ListedArray,
        Field(
            description="the records' response lies within this distance of `measured`, in the complex plane, with a "
            "probability of 95 % at each frequency; null: too few averages"
        ),
    ]
    averages: Annotated[ListedArray, Field(description="number of independent averages behind each value")]
    excited: Annotated[
        tuple[bool, ...], Field(description="whether the input moves there: density of 0.001 of its largest or more")
    ]

    @property
    def is_compared(self) -> Mask:
        """Return at which frequencies the input moves and the 95 % region leaves zero out, shape (n,), as booleans."""
        return np.array(self.excited) & (self.radius < np.abs(self.measured))

    @property
    def is_inside(self) -> Mask:
        """Return at which frequencies the model lies within the 95 % region of the records, shape (n,), as booleans."""
        return np.abs(self.simulated - self.measured) <= self.radius

    @property
    def excited_range(self) -> tuple[float, float]:
        """Return the lowest and the highest excited frequency [rad/s]."""
        omega = self.omega[np.array(self.excited)]
        return float(omega[0]), float(omega[-1])


# What identified models of roll, heave and pitch say in the field's terms, each value with its range.


@dataclass(frozen=True)
class IntervalEstimate:
    """A derived value, of draws their median, with its 95 % interval, SI."""

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


# What an identified craft with thrusters does and is made of, in the terms of those who steer it.


@dataclass(frozen=True)
class CommandCurve:
    """Thrust over command of the thrusters that share coefficients, with the commands of the training runs."""

    thrusters: tuple[str, ...]
    share: Annotated[tuple[Number, ...], Field(description="share of full command, -1 to 1")]
    thrust: Annotated[tuple[Number, ...], Field(description="in water at rest, unit `ThrusterCraft.force_unit`")]
    lower: Annotated[tuple[Number, ...], Field(description="95 % interval of `thrust`")]
    upper: Annotated[tuple[Number, ...], Field(description="as `lower`")]
    speed: Annotated[Number, Field(description="m/s through the water along the thruster, for `at_speed`")]
    at_speed: Annotated[tuple[Number, ...], Field(description="thrust at that speed")]
    edges: Annotated[tuple[Number, ...], Field(description="edges of the bins of `time_share`, shares of full command")]
    time_share: Annotated[
        tuple[Number, ...], Field(description="share of the training runs' time with a command in each bin")
    ]


@dataclass(frozen=True)
class CompassCurve:
    """Deviation of the compass over the heading it shows, with the headings of the training runs."""

    heading: Annotated[tuple[Number, ...], Field(description="rad, shown")]
    deviation: Annotated[tuple[Number, ...], Field(description="rad, true minus shown")]
    lower: Annotated[tuple[Number, ...], Field(description="95 % interval of `deviation`")]
    upper: Annotated[tuple[Number, ...], Field(description="as `lower`")]
    time_share: Annotated[
        tuple[Number, ...], Field(description="share of the training runs' time in each of equal bins of heading")
    ]


@dataclass(frozen=True)
class QuadrantMap:
    """Where one thruster worked: command over speed of the water along it, training runs against runs held out."""

    thruster: str
    order_edges: Annotated[tuple[Number, ...], Field(description="edges of the cells, shares of full command")]
    speed_edges: Annotated[tuple[Number, ...], Field(description="edges of the cells, m/s")]
    training: Annotated[
        tuple[tuple[Number, ...], ...], Field(description="share of the time in each cell; rows: command")
    ]
    held_out: Annotated[
        tuple[tuple[Number, ...], ...], Field(description="the same of the runs held out; empty: none held out")
    ]


@dataclass(frozen=True)
class CraftMeasure:
    """One thing the craft does, simulated with the estimate."""

    value: Number
    lower: Annotated[Number | None, Field(description="95 % interval; null: the records do not determine it")]
    upper: Annotated[Number | None, Field(description="as `lower`")]
    programme: Annotated[str, Field(description="what was simulated, as `seatrial simulate --manoeuvre` takes it")]
    extrapolation_index: Annotated[
        Number | None, Field(description="of that simulation; up to 1 is interpolation, null: not known")
    ] = None


@dataclass(frozen=True)
class FossenMatrix:
    """A matrix of M dnu/dt + C(M) nu + D(nu) nu = B T, nu = (u, v, r) [m/s, m/s, rad/s]."""

    name: str
    meaning: str
    values: Annotated[tuple[tuple[Number, ...], ...], Field(description="rows: surge, sway, yaw")]
    units: Annotated[tuple[tuple[str, ...], ...], Field(description="of each element")]


@dataclass(frozen=True)
class ThrusterCraft:
    """A craft with thrusters as it follows from the coefficients; bands and intervals at 95 %."""

    force_unit: Annotated[
        str, Field(description="N, or N/kg: forces on each kg of m + m_x, where no thrust is known in newtons")
    ]
    measures: Annotated[
        dict[str, CraftMeasure],
        Field(
            description="top_speed [m/s], surge_time_constant_s, yaw_rate_deg_s, time_360_s, yaw_time_constant_s, "
            "circle_yaw_rate_deg_s, tactical_diameter_L and time_90_s of a circle at 35 deg of the steering angle, "
            "stopping_distance_m, stopping_time_s, at full command; those that the simulation shows"
        ),
    ]
    curves: tuple[CommandCurve, ...]
    matrices: Annotated[
        tuple[FossenMatrix, ...],
        Field(description="M, parts of D(nu) = D + |u| D_u + |v| D_v + |r| D_r, and B for the thrusters in order"),
    ]
    thrusters: Annotated[tuple[str, ...], Field(description="columns of B")]
    quadrants: tuple[QuadrantMap, ...] = ()
    left_out: Annotated[
        tuple[str, ...], Field(description="coefficients that are not zero and stand in none of these matrices")
    ] = ()
    compass: Annotated[CompassCurve | None, Field(description="null: no deviation was estimated")] = None
