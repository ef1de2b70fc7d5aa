"""What was ordered in a zigzag, a turning circle or a pull-out, and whether another run repeats it."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, ObservedManoeuvre

# share by which orders and speeds of repeats differ at most; chosen: below the steps in which people order angles
_TOLERANCE = 0.1
_LEAST_ANGLE = math.radians(1.0)  # of a difference of angles that counts; chosen
_ORDER_STEP, _ORDER_TOLERANCE = 5.0, 1.2  # deg between angles that are ordered, and what readings miss; chosen
_TURNS = (ManoeuvreKind.TURNING_CIRCLE, ManoeuvreKind.PULL_OUT)  # in which the rudder is held over once, for long
_APPROACH = 5.0  # s at the start of a run whose mean is its speed; chosen


@dataclass(frozen=True)
class SteeredOrders:
    """What was ordered in a run.

    Attributes:
        rudder: rad; of a turn positive to starboard, of a zigzag without sign.
        heading: rad from the course at which a zigzag is checked; 0 of a turn.
        speed: m/s at the start; NaN where it was not recorded.
    """

    kind: ManoeuvreKind
    rudder: float
    heading: float
    speed: float

    @property
    def is_turn(self) -> bool:
        """Whether the rudder was held over once, for long."""
        return self.kind in _TURNS

    def is_repeated_by(self, other: "SteeredOrders") -> bool:
        """Return whether another run has the same orders, within what a helmsman repeats."""
        if self.kind is not other.kind or not _is_near(self.rudder, other.rudder, _LEAST_ANGLE):
            return False
        has_speeds = math.isfinite(self.speed) and math.isfinite(other.speed)
        return _is_near(self.heading, other.heading, _LEAST_ANGLE) and (
            not has_speeds or _is_near(self.speed, other.speed, 0.0)
        )


def steered_orders(record: Record) -> SteeredOrders | None:
    """Return the orders of a zigzag, a turning circle or a pull-out; None of others, and without rudder or heading."""
    try:
        run = ObservedManoeuvre.from_record(record)
    except InputError:
        return None
    if not run.holds or run.kind not in (ManoeuvreKind.ZIGZAG, *_TURNS):
        return None
    speed = initial_speed(record)
    if run.kind in _TURNS:
        return SteeredOrders(run.kind, run.longest_hold[0].angle, 0.0, speed)
    course, *turned = (run.psi_at(time) for time in run.executes)
    heading = float(np.median([abs(psi - course) for psi in turned])) if turned else 0.0
    return SteeredOrders(run.kind, float(np.median([abs(h.angle) for h in run.holds])), heading, speed)


def ordered_degrees(angle: float) -> float:
    """Return an angle [rad] in degrees as it was ordered: angles are ordered in steps of five, and read off by them."""
    degrees = math.degrees(angle)
    step = _ORDER_STEP * round(degrees / _ORDER_STEP)
    return step if step and abs(degrees - step) <= _ORDER_TOLERANCE else float(round(degrees))


def _is_near(one: float, other: float, least: float) -> bool:
    return abs(one - other) <= max(_TOLERANCE * max(abs(one), abs(other)), least)


def initial_speed(record: Record) -> float:
    """Return the mean speed ahead over the first seconds of a run [m/s]; NaN where it was not recorded."""
    if "u" not in record:
        return math.nan
    speeds = [record[name] for name in ("u", "v") if name in record]
    start = np.sqrt(np.sum(np.square(speeds), axis=0))[record.time <= record.time[0] + _APPROACH]  # in whichever frame
    return float(np.nanmean(start)) if np.isfinite(start).any() else math.nan
