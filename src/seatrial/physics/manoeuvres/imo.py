"""IMO's standards for ship manoeuvrability, resolution MSC.137(76), section 5.3, held against the measures of a record.

The stopping test (5.3.4) is not among them: no record here shows one.
"""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, ObservedManoeuvre

RESOLUTION = "IMO MSC.137(76)"
MINIMUM_LENGTH = 100.0  # m, MSC.137(76), of the ships that it is for
RUDDER_TOLERANCE = 1.0  # deg by which a rudder angle may be off; chosen
_HEADING_TOLERANCE = 0.2  # of a switching heading, by which it may be off; chosen


@dataclass(frozen=True)
class ImoCriterion:
    """One standard and how the ship does.

    Attributes:
        name: the measure's name, e.g. ``advance_L``.
        value, limit: in the unit the name ends in; the standard holds where value <= limit.
        is_fulfilled: whether it does.
        source: the paragraph.
        applies: whether the resolution applies to a ship of this length at full scale.
        note: what the reader must know, e.g. that the record is at model scale.
    """

    name: str
    value: float
    limit: float
    is_fulfilled: bool
    source: str
    applies: bool
    note: str


def imo_criteria(
    record: Record, length: float, scale: float = 1.0, switching: float | None = None, reference: Record | None = None
) -> tuple[ImoCriterion, ...]:
    """Return the standards that the record's manoeuvre allows to judge; empty where it allows none.

    Angles and lengths over L are the same at model scale; the time L/V on which overshoot limits rest is scaled by the
    square root of `scale` (Froude).

    Args:
        record: a zigzag of 10/10 or 20/20, or a turning circle with the largest rudder angle (35 deg).
        length: of the ship as recorded [m].
        scale: model scale 1:scale; 1 for full scale.
        switching: switching heading [rad] of a zigzag where it is known; by default the heading at the executes.
        reference: record whose manoeuvre and executes this one shares, as in `measures`; it decides which apply.

    Raises:
        InputError: as `measures`, or the scale is not positive.
    """
    if not scale > 0.0:
        raise InputError(f"the scale 1:{scale:g} is not positive")
    found = measures(record, length, switching, reference)
    seen = ObservedManoeuvre.from_record(record if reference is None else reference)
    match seen.kind:
        case ManoeuvreKind.TURNING_CIRCLE | ManoeuvreKind.PULL_OUT:  # the circle before the rudder went back
            wanted = _turning_limits(found)
        case ManoeuvreKind.ZIGZAG:
            wanted = _zigzag_limits(seen, found, length, scale, switching)
        case _:
            wanted = []
    applies, note = _scope(length * scale, scale)
    return tuple(
        ImoCriterion(name, found[name], limit, found[name] <= limit, f"{RESOLUTION}, {paragraph}", applies, note)
        for name, limit, paragraph in wanted
        if name in found
    )


def first_overshoot_limit(time: float) -> float:
    """Return the limit [deg] of the first overshoot of a 10/10 zigzag, L/V in s: 5.3.3.1."""
    return float(np.clip(5.0 + 0.5 * time, 10.0, 20.0))  # deg; time is L/V in s; MSC.137(76), 5.3.3


def second_overshoot_limit(time: float) -> float:
    """Return the limit [deg] of the second overshoot of a 10/10 zigzag, L/V in s: 5.3.3.2."""
    return float(np.clip(17.5 + 0.75 * time, 25.0, 40.0))  # deg; time is L/V in s; MSC.137(76), 5.3.3


def _turning_limits(values: dict[str, float]) -> list[tuple[str, float, str]]:
    if values["rudder_deg"] < 35.0 - RUDDER_TOLERANCE:  # deg, the largest of most rudders
        return []
    return [("advance_L", 4.5, "5.3.1"), ("tactical_diameter_L", 5.0, "5.3.1")]  # ship lengths, MSC.137(76)


def _zigzag_limits(
    manoeuvre: ObservedManoeuvre, values: dict[str, float], length: float, scale: float, switching: float | None
) -> list[tuple[str, float, str]]:
    rudder, heading = values["rudder_deg"], math.degrees(switching) if switching else switching_heading(manoeuvre)
    wanted: list[tuple[str, float, str]] = []
    if abs(rudder - 10.0) <= RUDDER_TOLERANCE:
        wanted.append(("initial_turning_L", 2.5, "5.3.2"))  # ship lengths, MSC.137(76)
        if abs(heading - 10.0) <= _HEADING_TOLERANCE * 10.0 and values.get("approach_speed", 0.0) > 0.0:
            time = length / values["approach_speed"] * math.sqrt(scale)
            wanted.append(("overshoot_1_deg", first_overshoot_limit(time), "5.3.3.1"))
            wanted.append(("overshoot_2_deg", second_overshoot_limit(time), "5.3.3.2"))
    twenty = 20.0  # deg, rudder and heading of the zigzag 20/20
    if abs(rudder - twenty) <= RUDDER_TOLERANCE and abs(heading - twenty) <= _HEADING_TOLERANCE * twenty:
        wanted.append(("overshoot_1_deg", 25.0, "5.3.3.3"))  # deg, MSC.137(76)
    return wanted


def switching_heading(manoeuvre: ObservedManoeuvre) -> float:
    """Median heading off the course [deg] at the second and later executes of a zigzag; NaN where there are none."""
    course = manoeuvre.psi_at(manoeuvre.executes[0])
    off = [abs(manoeuvre.psi_at(t) - course) for t in manoeuvre.executes[1:]]
    return math.degrees(float(np.median(off))) if off else math.nan


def _scope(full_length: float, scale: float) -> tuple[bool, str]:
    notes = []
    if scale != 1.0:
        notes.append(
            f"model scale 1:{scale:g}: compared in ship lengths and Froude-scaled time; scale effects not removed"
        )
    applies = full_length >= MINIMUM_LENGTH
    if not applies:
        notes.append(f"the resolution is for ships of {MINIMUM_LENGTH:g} m and more; this one has {full_length:g} m")
    return applies, "; ".join(notes)
