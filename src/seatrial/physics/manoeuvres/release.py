"""A release: a ship that rolls is let go from an angle and rolls out, as in a decay test (ITTC 7.5-02-07-04.5)."""

import math

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.physics.hydro.free_roll import swing_extremes
from seatrial.physics.manoeuvres.programme import SIDES

EXAMPLE = "release:15 or release:15:port"
_LARGEST = 60.0  # deg, beyond which no decay test goes; chosen


def release_angle(text: str) -> float:
    """Return the angle [rad] of ``release:15`` or ``release:15:port``, from the angle of rest, positive to starboard.

    Raises:
        InputError: the text names no release, or its angle is not between 0 and 60 degrees.
    """
    kind, *fields = text.strip().split(":")
    side = SIDES.get(fields[1], 0) if len(fields) == 2 else int(len(fields) == 1)
    try:
        angle = float(fields[0]) if kind == "release" and side else math.nan
    except ValueError:
        angle = math.nan
    if math.isnan(angle):
        raise InputError(f"unknown manoeuvre '{text}' of a model that only rolls; known is {EXAMPLE} (deg)")
    if not 0.0 < angle <= _LARGEST:
        raise InputError(f"the angle {fields[0]} of a release is not between 0 and {_LARGEST:g} degrees")
    return side * math.radians(angle)


def roll_measures(record: Record) -> dict[str, float]:
    """Return measures of a decay that begins with its release, by name; those it does not show are absent.

    ``swing_1_deg`` and ``swing_2_deg``, the extremes to the other side and back; ``period_s``, from the release to the
    second of them; ``half_time_s``, until swings are half as large as the release, log-linear between extremes.
    """
    roll = record["phi"]
    if not np.all(np.isfinite(roll)) or roll[0] == 0.0:
        return {}
    times, sizes = swing_extremes(roll, record.dt)
    measures = {f"swing_{k}_deg": math.degrees(size) for k, size in enumerate(sizes[:2], start=1)}
    if len(times) > 1:
        measures["period_s"] = float(times[1])
    sizes, times = np.append(abs(roll[0]), sizes), np.append(0.0, times)
    if sizes[-1] <= 0.5 * sizes[0]:
        lower = int(np.argmax(sizes <= 0.5 * sizes[0]))
        share = math.log(2.0 * sizes[lower - 1] / sizes[0]) / math.log(sizes[lower - 1] / sizes[lower])
        measures["half_time_s"] = float(times[lower - 1] + share * (times[lower] - times[lower - 1]))
    return measures
