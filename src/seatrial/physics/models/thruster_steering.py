"""Steering by an angle: thrusters that turn, and rudders behind screws, as one order to starboard like a rudder's.

Thrust turned by a small angle a has the yaw moment T (x a - y) (Fossen 2021, section 9.2): a thruster abaft the origin
turns the craft to starboard by thrust to port, one before it by thrust to starboard.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Channel, Record
from seatrial.core.values.notation import OPPOSITE
from seatrial.physics.models.thruster_layout import AngleInput, ThrusterLayout

ORDER = "delta"
"""Channel and input of the order [rad], positive to starboard as a rudder's angle."""
_NO_ARM = 0.05
"""Arm along the craft over the longest one below which a thruster does not steer by its angle; chosen."""

_ABEAM = 0.5 * math.pi + 1e-6  # rad: thrust across the craft, and rounding


@dataclass(frozen=True)
class SteeringAngle:
    """A channel of angles that steer a craft, and its sign: the angle over the order to starboard, +1 or -1."""

    channel: str
    sign: float


def steering_angles(layout: ThrusterLayout) -> tuple[SteeringAngle, ...]:
    """Return the angles that steer a craft, each channel once; empty where all thrusters are fixed.

    A channel that turns several thrusters has the sign of the sum of their arms.
    """
    arms: dict[str, float] = {}
    for channel, arm in _arms(layout):
        arms[channel] = arms.get(channel, 0.0) + arm
    longest = max(map(abs, arms.values()), default=0.0)
    return tuple(
        SteeringAngle(channel, math.copysign(1.0, arm)) for channel, arm in arms.items() if abs(arm) > _NO_ARM * longest
    )


def _arms(layout: ThrusterLayout) -> Iterator[tuple[str, float]]:
    """Channels of angles with the arm [m] by which thrust or lift at a positive angle turns the craft to starboard."""
    for thruster in layout.thrusters:
        if isinstance(thruster.angle, AngleInput):
            yield thruster.angle.channel, thruster.x
        if thruster.rudder is not None:
            yield thruster.rudder.channel, -thruster.rudder.x  # lift of a positive angle is to port


def order_text(layout: ThrusterLayout) -> str:
    """Return what an order stands for: ``alpha_1 = -delta``; empty where the order is the angle itself."""
    signs = {1.0: "", -1.0: "-"}
    angles = [angle for angle in steering_angles(layout) if (angle.channel, angle.sign) != (ORDER, 1.0)]
    return ", ".join(f"{angle.channel} = {signs[angle.sign]}{ORDER}" for angle in angles)


def with_steering_order(record: Record, layout: ThrusterLayout) -> Record:
    """Return the record with `ORDER`, the mean of what its steering angles stand for, where it has all of these.

    A record that has the channel, one of a craft without such angles, and one in which an azimuth thruster turns beyond
    abeam, where it is no rudder any more, is returned as it is.
    """
    angles = steering_angles(layout)
    if not angles or ORDER in record or any(angle.channel not in record for angle in angles):
        return record
    turned = [angle.sign * _to_starboard(record.channel(angle.channel)) for angle in angles]
    if np.nanmax(np.abs(turned), initial=0.0) > _ABEAM:
        return record
    return record.with_channel(ORDER, Channel.from_notation(ORDER, np.mean(turned, axis=0)))


def _to_starboard(channel: Channel) -> np.ndarray:
    return -channel.values if channel.positive == OPPOSITE["starboard"] else channel.values
