"""Station keeping of a craft with thrusters: gains, margins, allocation, what it can hold, how it was tried. SI."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import ListedArray, Number, StoredRecord


@dataclass(frozen=True, eq=False)
class StationMargins:
    """Margins of three loops at once, with the dead time: each |S_ii| with the other loops closed."""

    surge: Annotated[Number, Field(description="Ms of the surge loop; null: unstable")]
    sway: Annotated[Number, Field(description="Ms of the sway loop; null: unstable")]
    yaw: Annotated[Number, Field(description="Ms of the yaw loop; null: unstable")]
    joint: Annotated[
        Number, Field(description="largest singular value of S, yaw times half the length; null: unstable")
    ]
    delay_margin: Annotated[Number, Field(description="s of dead time more that all thrusters may have; null: any")]


@dataclass(frozen=True, eq=False)
class StationPrecision:
    """How well a place is kept with which thrust."""

    position: Annotated[Number, Field(description="rms distance from the station, m")]
    heading: Annotated[Number, Field(description="rms, rad")]
    thrust: Annotated[Number, Field(description="rms over the thrusters, each as a share of its largest thrust")]


@dataclass(frozen=True, eq=False)
class StationFront:
    """Bandwidths of which none gives less error at the ends of the hull with less thrust, within the limits."""

    position_bandwidth: Annotated[ListedArray, Field(description="rad/s, shape (n,)")]
    heading_bandwidth: Annotated[ListedArray, Field(description="rad/s, shape (n,)")]
    error: Annotated[
        ListedArray, Field(description="m, rms of position and of half the length times heading, shape (n,)")
    ]
    thrust: Annotated[ListedArray, Field(description="as in `StationPrecision`, shape (n,)")]
    evaluations: Annotated[int, Field(description="number of controllers evaluated")]


@dataclass(frozen=True, eq=False)
class StationThruster:
    """One thruster as the controller orders it: thrust from an inverse, share of full command from a table."""

    name: str
    inverse: Annotated[
        ListedArray,
        Field(description="thrust over (X, Y, N), shape (1, 3); of an azimuth thruster ahead and to starboard, (2, 3)"),
    ]
    share: Annotated[ListedArray, Field(description="share of full command, rising, shape (k,)")]
    thrust: Annotated[ListedArray, Field(description="at these shares in water at rest, shape (k,)")]


@dataclass(frozen=True, eq=False)
class StationCapability:
    """The largest steady current and force that the thrusters hold, by direction off the bow, yaw in balance.

    By linear programming within the limits in water at rest; static, without a reserve for what varies.
    """

    direction: Annotated[ListedArray, Field(description="from which it comes, rad clockwise off the bow, shape (n,)")]
    current: Annotated[ListedArray, Field(description="m/s that is held, shape (n,)")]
    current_shared_out: Annotated[ListedArray, Field(description="m/s that the generalised inverse holds, shape (n,)")]
    force: Annotated[ListedArray, Field(description="held without moment, shape (n,)")]
    limiting: Annotated[
        tuple[tuple[str, ...], ...], Field(description="thrusters at their limits in the largest current, (n,)")
    ]


@dataclass(frozen=True, eq=False)
class StationTrial:
    """The nonlinear craft on station, sampled controller, limits of the thrusters; each current direction once."""

    directions: Annotated[ListedArray, Field(description="from which the current comes, rad off the bow, shape (k,)")]
    position: Annotated[Number, Field(description="rms distance from the station, m")]
    radius: Annotated[float, Field(description="m within which it stays 95 % of the time")]
    heading: Annotated[Number, Field(description="rms, rad")]
    thrust: Annotated[Number, Field(description="as in `StationPrecision`")]
    cut: Annotated[Number, Field(description="share of the time in which forces exceed the limits")]
    used: Annotated[ListedArray, Field(description="rms thrust over the largest of each thruster, (thrusters,)")]
    record: Annotated[StoredRecord, Field(description="of the direction with the largest radius: place and heading")]
    draws: Annotated[int, Field(description="craft drawn from the fit's covariance")]
    stable_draws: Annotated[int, Field(description="of these, with a stable loop that does not run away")]
    worst_radius: Annotated[Number, Field(description="m, the largest of the stable ones; null: none")]


@dataclass(frozen=True, eq=False)
class StationKeeping:
    """tau = -K_p R'e - K_i R' int(e) dt - K_d v (Fossen 2021, Algorithm 15.2), v: R' de/dt behind s / (T_f s + 1).

    e: pose less the pose ordered, north, east, heading; R: rotation by the heading; gains of surge, sway, yaw.
    """

    position_bandwidth: Annotated[Number, Field(description="natural frequency in surge and sway, rad/s")]
    heading_bandwidth: Annotated[Number, Field(description="natural frequency in yaw, rad/s")]
    damping: Annotated[Number, Field(description="relative damping of the pole pairs")]
    integral_share: Annotated[Number, Field(description="pole of the integral over the natural frequency")]
    KP: Annotated[ListedArray, Field(description="shape (3, 3)")]
    KI: Annotated[ListedArray, Field(description="shape (3, 3)")]
    KD: Annotated[ListedArray, Field(description="shape (3, 3)")]
    gain_units: Annotated[
        dict[str, tuple[tuple[str, ...], ...]], Field(description="KP, KI, KD -> unit of each element")
    ]
    filter_lag: Annotated[ListedArray, Field(description="T_f of surge, sway, yaw, s, shape (3,)")]
    sample_s: Annotated[Number, Field(description="sample time of the controller, s")]
    dead_time: Annotated[Number, Field(description="s, of thrusters and half a sample, that the margins hold at")]
    force_unit: Annotated[str, Field(description="N, or N/kg: forces on each kg of m + m_x")]
    current: Annotated[Number, Field(description="m/s, the steady current of the trial")]
    disturbances: Annotated[tuple[str, ...], Field(description="what varies besides, a sentence each")]
    margins: StationMargins
    predicted: Annotated[StationPrecision, Field(description="by linear theory, without the steady current")]
    front: StationFront
    thrusters: tuple[StationThruster, ...]
    capability: StationCapability
    trial: StationTrial
