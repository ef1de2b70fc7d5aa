"""Held-out runs that repeat a trained manoeuvre: same kind, same orders, same speed, by what the runs show."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Prediction
from seatrial.core.text.words import enumeration
from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres import ManoeuvreKind, ObservedManoeuvre

# share by which orders and speeds of repeats differ at most; chosen: below the steps in which people order angles
_TOLERANCE = 0.15
_LEAST_ANGLE = math.radians(1.0)  # of a difference of angles that counts; chosen
_APPROACH = 5.0  # s at the start of a run whose mean is its speed; chosen
MAX_NAMES = 3  # of runs that a sentence holds; chosen


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

    def is_repeated_by(self, other: "SteeredOrders") -> bool:
        """Return whether another run has the same orders, within what a helmsman repeats."""
        if self.kind is not other.kind or not _is_near(self.rudder, other.rudder, _LEAST_ANGLE):
            return False
        has_speeds = math.isfinite(self.speed) and math.isfinite(other.speed)
        return _is_near(self.heading, other.heading, _LEAST_ANGLE) and (
            not has_speeds or _is_near(self.speed, other.speed, 0.0)
        )


def steered_orders(record: Record) -> SteeredOrders | None:
    """Return the orders of a zigzag or a turning circle; None of any other run, and without rudder or heading."""
    try:
        run = ObservedManoeuvre.from_record(record)
    except InputError:
        return None
    if not run.holds or run.kind not in (ManoeuvreKind.ZIGZAG, ManoeuvreKind.TURNING_CIRCLE):
        return None
    speed = _approach_speed(record)
    if run.kind is ManoeuvreKind.TURNING_CIRCLE:
        return SteeredOrders(run.kind, run.longest_hold[0].angle, 0.0, speed)
    course, *turned = (run.psi_at(time) for time in run.executes)
    heading = float(np.median([abs(psi - course) for psi in turned])) if turned else 0.0
    return SteeredOrders(run.kind, float(np.median([abs(h.angle) for h in run.holds])), heading, speed)


def repeated_runs(p: Prediction, predictions: Sequence[Prediction]) -> list[str]:
    """Return the names of the training runs whose manoeuvre a held-out run repeats."""
    orders = steered_orders(p.measured)
    if orders is None:
        return []
    trained = ((one.record, steered_orders(one.measured)) for one in predictions if one.role == "training")
    return [name for name, other in trained if other is not None and orders.is_repeated_by(other)]


def repeat_clause(p: Prediction, predictions: Sequence[Prediction]) -> str:
    """Return which trained manoeuvre a held-out run repeats, and what that leaves open; empty where it repeats none."""
    names = repeated_runs(p, predictions)
    if not names:
        return ""
    were = "which was" if len(names) == 1 else "which were"
    return f"a repeat of {enumeration(names, MAX_NAMES)}, {were} fitted: it does not test other manoeuvres"


def _is_near(one: float, other: float, least: float) -> bool:
    return abs(one - other) <= max(_TOLERANCE * max(abs(one), abs(other)), least)


def _approach_speed(record: Record) -> float:
    if "u" not in record:
        return math.nan
    start = record["u"][record.time <= record.time[0] + _APPROACH]
    return float(np.nanmean(start)) if np.isfinite(start).any() else math.nan
