"""The time in which a ship changes its motion, by which segments, windows and search intervals are measured."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.estimate.settings import SEGMENT_SHIP_LENGTHS
from seatrial.physics.hydro.excitation import G

PERIOD_SHARE = 0.4
"""Time scale of a rolling ship as a share of its period; windows of the start are then 0.6 periods wide each side."""


def ship_length_seconds(records: Sequence[Record], length: float, segment_seconds: float | None = None) -> float:
    """Return L/U [s], the time in which the ship travels its length at the median speed of the records.

    Records without any speed take it from the segment length that is set, if it is finite.

    Raises:
        InputError: the records show no speed.
    """
    speeds = []
    for record in records:
        if "u" in record:
            speeds.append(np.nanmedian(np.abs(record["u"])))
        elif {"x0", "y0"} <= set(record.channels):
            speeds.append(np.median(np.hypot(np.diff(record["x0"]), np.diff(record["y0"]))) / record.dt)
    if not speeds and segment_seconds is not None and np.isfinite(segment_seconds):
        return segment_seconds / SEGMENT_SHIP_LENGTHS
    if not speeds or np.median(speeds) <= 0:
        raise InputError("the records show no forward speed; give u or positions, or set estimate.segment_s")
    return length / float(np.median(speeds))


def characteristic_time(
    model: Model, records: Sequence[Record], length: float, segment_seconds: float | None = None
) -> float:
    """Return the time [s] in which the ship changes its motion: L/U if steered, sqrt(L/g) for a linear model in waves.

    For roll (a model without heading that is not linear) it is a share of the period in the records.

    Raises:
        InputError: a ship is steered and the records show no speed.
    """
    if model.is_affine:
        return float(np.sqrt(length / G))
    if is_pure_roll(model):
        return PERIOD_SHARE * float(np.median([dominant_period(r[model.states[0]], r.dt) for r in records]))
    if "u" not in model.states and segment_seconds is None and not any(_shows_speed(r) for r in records):
        return yaw_time(records)
    return ship_length_seconds(records, length, segment_seconds)


def _shows_speed(record: Record) -> bool:
    return "u" in record or {"x0", "y0"} <= set(record.channels)


def yaw_time(records: Sequence[Record]) -> float:
    """Return the time [s] in which the yaw rate changes: 1/omega of its dominant period, the median of the records.

    For steering models of records that show no speed.

    Raises:
        InputError: no record holds r or psi, or none moves.
    """
    turning = [r for r in records if {"r", "psi"} & set(r.channels)]
    rates = [(r["r"] if "r" in r else np.gradient(r["psi"], r.dt), r.dt) for r in turning]
    if not rates:
        raise InputError("the records show neither speed nor yaw; give r or psi, or set estimate.segment_s")
    return float(np.median([_strongest_period(rate, dt, 1) for rate, dt in rates])) / (2.0 * math.pi)


def is_pure_roll(model: Model) -> bool:
    """Return whether the ship swings about a rest: a model without heading and surge."""
    return not {"psi", "u"} & {*model.states, *model.input_names}


_PADDED = 4  # lengths of the record over which its spectrum is taken, so that it has places between; chosen


def dominant_period(values: Array, dt: float) -> float:
    """Period [s] at which the motion (n,) about its mean has most power.

    Raises:
        InputError: it does not move, or never swings.
    """
    period = _strongest_period(values, dt, 0)
    if period > len(values) * dt:
        raise InputError("the motion never swings about its mean; give a longer record, from the release on")
    return period


def _strongest_period(values: Array, dt: float, least_cycles: int) -> float:
    """Period [s] of most power among those of which the record (n,) holds so many cycles; infinite at zero frequency.

    Raises:
        InputError: it does not move.
    """
    power = np.abs(np.fft.rfft(values - values.mean(), _PADDED * len(values)))
    first = _PADDED * least_cycles
    peak = first + int(np.argmax(power[first:]))
    if not power[peak] > 0.0:
        raise InputError("the motion never swings about its mean; give a longer record, from the release on")
    return _PADDED * len(values) * dt / peak if peak else math.inf
