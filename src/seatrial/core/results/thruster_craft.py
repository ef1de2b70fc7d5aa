"""What an identified craft with thrusters does and is made of, in the terms of those who steer it."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number


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
