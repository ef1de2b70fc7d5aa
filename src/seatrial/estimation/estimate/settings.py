"""Constants of the decision table, what one estimate needs that no trial file sets, and the time scale of a ship."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.physics.hydro.excitation import G

# Constants of the decision table, and what one estimate needs that no trial file sets.

SEGMENT_SHIP_LENGTHS = 1.5
"""Length of a multiple-shooting segment, in ship lengths travelled (1.5 L/U)."""

WEAK_FORM_SHIP_LENGTHS = 1.5
"""Half width of the weak form's windows, in ship lengths travelled."""

HUBER_LIMIT = 3.0
"""Residuals beyond this many standard deviations count linearly where the loss is robust."""

WHITE_INFLATION = 1.3
"""Residuals whose correlation inflates the variance of a mean by less than this count as white."""

INITIAL_STATE_SHIP_LENGTHS = 1.0
"""The initial state of a validation run comes from its first L/U seconds."""

JUDGED_SHIP_LENGTHS = 5.0
"""Criteria are judged in windows of 5 L/U, besides whole quarters of runs; chosen."""


class IntervalMethod(StrEnum):
    """Where intervals come from; `auto` is the decision table's choice."""

    AUTO = "auto"
    JACKKNIFE = "jackknife"
    BOOTSTRAP = "bootstrap"
    PROFILE = "profile"
    SAMPLING = "sampling"


@dataclass(frozen=True)
class EstimatorOptions:
    """How one estimate is computed.

    Attributes:
        intervals: where intervals come from; seed: of what is drawn for them.
        evaluations: limit of each search.
        workers: threads; None: one for each core.
        windows: in which validation runs are predicted as well, as ``10s,5L``; empty: by the length of the run.
        horizons: of the k-step errors, samples or seconds, as ``1,10,5s``; empty: by the length of the runs.
    """

    intervals: IntervalMethod = IntervalMethod.AUTO
    seed: int = 0
    evaluations: int = 60
    workers: int | None = None
    windows: str = ""
    horizons: str = ""


# The time in which a ship changes its motion, by which segments, windows and search intervals are measured.

SAMPLES_OF_CHANGE = 5
"""Readings of the slowest channel in the time in which records show a change, at least; chosen: a segment then holds
seven, from which its states at the start are known."""

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
            moved = np.flatnonzero(np.append(True, np.hypot(np.diff(record["x0"]), np.diff(record["y0"])) != 0.0))
            ways = np.hypot(np.diff(record["x0"][moved]), np.diff(record["y0"][moved]))  # between places that differ
            speeds.append(np.median(ways / (record.dt * np.diff(moved))) if len(moved) > 1 else 0.0)
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
    if not model.has_course:
        return PERIOD_SHARE * float(np.median([dominant_period(r[model.states[0]], r.dt) for r in records]))
    if not model.has_speed and segment_seconds is None and not any(shows_speed(r) for r in records):
        return yaw_time(records)
    return ship_length_seconds(records, length, segment_seconds)


def resolved_time(
    model: Model, records: Sequence[Record], length: float, segment_seconds: float | None = None
) -> float:
    """Return the time [s] in which records show how the ship changes its motion.

    It is the ship's own, of a steered ship no less than a few readings of the slowest channel.

    Raises:
        InputError: as `characteristic_time`.
    """
    own = characteristic_time(model, records, length, segment_seconds)
    return max(own, SAMPLES_OF_CHANGE * _slowest_step(model, records)) if model.has_course and own > 0.0 else own


def weak_form_half_width(model: Model, records: Sequence[Record], unit: float) -> float:
    """Return the half width [s] of the weak form's windows; unit: the ship's characteristic time [s].

    Of a steered ship that rolls they are no wider than those of roll alone: a window as wide as its period, that of
    the record with the largest roll rate, averages roll away.
    """
    half = WEAK_FORM_SHIP_LENGTHS * unit
    rates = [(np.nan_to_num(record["p"] - np.nanmean(record["p"])), record.dt) for record in records if "p" in record]
    if not (model.has_course and "p" in model.states and rates):
        return half
    largest, dt = max(rates, key=lambda rate: float(np.std(rate[0])))
    if not np.any(largest):
        return half
    return min(half, WEAK_FORM_SHIP_LENGTHS * PERIOD_SHARE * _strongest_period(largest, dt, 1))


def _slowest_step(model: Model, records: Sequence[Record]) -> float:
    """Time [s] between readings of the motion that is read most seldom, the median over the records."""
    steps = []
    for record in records:
        counts = [int(np.isfinite(record.measured(c)).sum()) for c in record.channels if c in model.observables]
        steps += [record.dt * len(record) / min(filter(None, counts))] if any(counts) else []
    return float(np.median(steps)) if steps else 0.0


def shows_speed(record: Record) -> bool:
    """Return whether a record says how fast the craft went: by u or by positions."""
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
