"""Measures of a manoeuvre as IMO and ITTC define them, from a measured or a simulated record alike."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, Index, InputError, Record
from seatrial.physics.manoeuvres.programme import roll_measures
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, ObservedManoeuvre, own_motion, to_starboard
from seatrial.physics.manoeuvres.track import Swing, mean_between, peak, speed, steady_turning

# Values that a measure can take, and intervals that stay among them.

UNDETERMINED_FACTOR = 5.0
"""An interval from a fifth to five times the value says nothing: the measure is not determined; chosen."""
LARGEST_DRIFT = 90.0  # deg; beyond it the craft goes astern, which no steady turn ahead does


@dataclass(frozen=True)
class _Scale:
    """A scale on which a measure has no limits: `to` it, `back` from it, and its `slope` d(scale)/d(measure)."""

    to: Callable[[float], float]
    back: Callable[[float], float]
    slope: Callable[[float], float]


_LOGARITHM = _Scale(math.log, math.exp, lambda value: 1.0 / value)  # of what is positive
_RETAINED_SHARE = _Scale(  # of a share lost, which is below one: the logarithm of the share that is left
    lambda value: math.log1p(-value), lambda scaled: -math.expm1(scaled), lambda value: 1.0 / (1.0 - value)
)
_DRIFT = _Scale(  # of an angle between -90 and 90 deg
    lambda value: math.atanh(value / LARGEST_DRIFT),
    lambda scaled: LARGEST_DRIFT * math.tanh(scaled),
    lambda value: LARGEST_DRIFT / (LARGEST_DRIFT**2 - value**2),
)


def bounded_interval(name: str, value: float, half_width: float) -> tuple[float, float] | None:
    """Return the interval of a measure within the values it can take, by the delta method on a scale without limits.

    Lengths, times, speeds and rudder angles are positive, as are overshoots and steady yaw rates; a share lost is below
    one, a drift angle within 90 deg. What is narrow stays symmetric about its value.

    Args:
        half_width: of the symmetric interval, in the unit of the measure.

    Returns:
        None where the measure is not determined: the interval would reach a fifth or five times the value, or all
        drift angles; or the value itself is none that the measure can take.
    """
    scale = _scale_of(name)
    if scale is None:
        return value - half_width, value + half_width
    try:
        centre, half = scale.to(value), half_width * scale.slope(value)
    except (ValueError, ZeroDivisionError):
        return None
    if not half <= math.log(UNDETERMINED_FACTOR):
        return None
    ends = (scale.back(centre - half), scale.back(centre + half))
    return min(ends), max(ends)


def _scale_of(name: str) -> _Scale | None:
    """None: the measure has no limits (transfer, residual yaw rate)."""
    if name == "speed_loss":
        return _RETAINED_SHARE
    if name in ("steady_drift_deg", "steady_heel_deg"):
        return _DRIFT
    if name in _UNLIMITED:
        return None
    return _LOGARITHM


_UNLIMITED = frozenset({"transfer_L", "residual_yaw_rate_deg_s"})


# Measures of runs of craft with thrusters, read from commands and motion alone: speed, turn rate, stop, overshoots.

_FULL_TURN = float(np.radians(360.0))
_RISE = 1.0 - float(np.exp(-1.0))  # of a step that a first-order lag has reached after its time constant
_MOVED = 1e-6  # share of a command's range by which it has changed; chosen
_LAST_SHARE = 0.25  # of a spin, over which its rate is taken; chosen


def commands_of(record: Record) -> tuple[str, ...]:
    """Return the record's channels that command thrusters."""
    return tuple(name for name in record.channels if name.split("_")[0] in ("command", "rpm") and name[-1].isdigit())


def thrust_measures(record: Record) -> dict[str, float]:
    """Return measures of the manoeuvre that a record of a craft with thrusters shows, by name.

    Spin (commands held, more than a turn): ``steady_yaw_rate_deg_s``, ``time_360_s``, ``time_constant_s`` to 63 % of
    the rate. Straight run (commands held):
    ``steady_speed`` [m/s], ``time_constant_s`` to 63 % of it. Stop (the speed falls through zero behind a change of
    commands): ``approach_speed`` [m/s], ``stopping_distance_m``, ``stopping_time_s``. Zigzag (two changes and more,
    between the same two commands): ``approach_speed``, ``overshoot_1_deg`` and so on, ``period_s``. Commands that
    change otherwise are no manoeuvre: no measures.

    Raises:
        InputError: heading or surge speed is missing.
    """
    for name in ("psi", "u"):
        if name not in record:
            raise InputError(f"record '{record.name}' has no '{name}', which measures of a craft with thrusters need")
    psi, executes = np.unwrap(record["psi"]), _changes(record)
    if len(executes) == 0:
        return _spin(record.time, psi) if abs(psi[-1] - psi[0]) > _FULL_TURN else _straight(record)
    if len(executes) == 1:
        return _stop(record, int(executes[0]))
    if not _alternates(record, executes):
        return {}
    return {"approach_speed": float(record["u"][executes[0]])} | _overshoots(record.time, psi, executes)


def _changes(record: Record) -> Index:
    """Rows at which commands change, each change once."""
    values = np.stack([record[name] for name in commands_of(record)], axis=1)
    moved = np.any(np.abs(np.diff(values, axis=0)) > _MOVED * np.maximum(np.ptp(values, axis=0), _MOVED), axis=1)
    rows = np.flatnonzero(moved)
    return rows[np.diff(rows, prepend=-2) > 1] if len(rows) else rows


def _alternates(record: Record, executes: Index) -> bool:
    """Whether commands after the first change alternate between two settings."""
    values = np.stack([record[name] for name in commands_of(record)], axis=1)
    held = values[[*executes[1:], len(values) - 1]]  # the last sample of what each change ordered
    near = _MOVED * np.maximum(np.ptp(values, axis=0), _MOVED)
    return bool(np.all(np.abs(held[2:] - held[:-2]) <= near))


def _spin(time: Array, psi: Array) -> dict[str, float]:
    last = time >= time[-1] - _LAST_SHARE * (time[-1] - time[0])
    turned = np.abs(psi - psi[0])
    rate = abs(np.polyfit(time[last], psi[last], 1)[0])
    speed = np.maximum.accumulate(np.gradient(turned, time))
    return {
        "steady_yaw_rate_deg_s": float(np.degrees(rate)),
        "time_360_s": float(np.interp(_FULL_TURN, turned, time) - time[0]),
        "time_constant_s": float(np.interp(_RISE * rate, speed, time) - time[0]),
    }


def _straight(record: Record) -> dict[str, float]:
    u = record["u"]
    steady = float(u[-1])
    if steady == u[0]:
        return {"steady_speed": steady}
    rising = np.maximum.accumulate((u - u[0]) / (steady - u[0]))
    return {"steady_speed": steady, "time_constant_s": float(np.interp(_RISE, rising, record.time) - record.time[0])}


def _stop(record: Record, row: int) -> dict[str, float]:
    u, time = record["u"][row:], record.time[row:]
    approach = {"approach_speed": float(u[0])}
    ended = np.flatnonzero(u * np.sign(u[0]) <= 0.0)
    if not len(ended) or u[0] == 0.0:
        return approach
    k = int(ended[0])
    share = u[k - 1] / (u[k - 1] - u[k])
    stopped = time[k - 1] + share * (time[k] - time[k - 1])
    speeds, times = np.append(u[:k], 0.0), np.append(time[:k], stopped)
    distance = np.sum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times))
    return approach | {"stopping_distance_m": float(abs(distance)), "stopping_time_s": float(stopped - time[0])}


def _overshoots(time: Array, psi: Array, executes: Index) -> dict[str, float]:
    """Overshoot k: how far the heading goes on behind execute k + 1; none where it does not turn back."""
    ends, measures, peaks = [*executes[2:], len(psi) - 1], {}, []
    for k, (execute, end) in enumerate(zip(executes[1:], ends, strict=True), start=1):
        side = np.sign(psi[execute] - psi[executes[k - 1]])
        extreme = peak(time, side * (psi - psi[execute]), float(time[execute]), float(time[end]))
        if extreme is not None:
            measures[f"overshoot_{k}_deg"] = float(np.degrees(extreme[1]))
            peaks.append(extreme[0])
    periods = [2.0 * (b - a) for a, b in pairwise(peaks)]
    return measures | ({"period_s": float(np.mean(periods))} if periods else {})


# Measures of a manoeuvre as IMO and ITTC define them, from a measured or a simulated record alike.

QUARTER_TURN, HALF_TURN = float(np.radians(90.0)), float(np.radians(180.0))
INITIAL_TURN = float(np.radians(10.0))
ORDERED_MEASURE = "rudder_deg"
"""The measure that is the order itself: no simulation predicts it."""
_RESIDUAL_SHARE = 0.1  # of the time amidships, over which the residual rate is taken; chosen


def measures(
    record: Record, length: float, switching: float | None = None, reference: Record | ObservedManoeuvre | None = None
) -> dict[str, float]:
    """Return measures of the manoeuvre the record shows, by name; those it does not allow are absent.

    Args:
        record: needs ``psi`` and ``delta``; of a craft with thrusters see `thrust_measures`, of a
            decay of roll `roll_measures`.
            ``x0``, ``y0`` for distances, ``u``, ``v``, ``r`` for speeds and rates; speeds of a measured record without
            ``u`` come from its positions. A
            simulated record without ``u`` is that of a model without surge, whose distances mean nothing.
        length: of the ship [m], the unit of names ending in ``_L``.
        switching: switching heading [rad] of a zigzag where it is known; overshoots are counted from it. By default
            they are counted from the heading at which the rudder began to move.
        reference: record of the same rudder history and times, e.g. the measured run of which `record` is the open
            loop simulation, or the manoeuvre recognised on it, where many records share one. Manoeuvre and executes are
            then made out on it, so that a heading that drifts off hides nothing; headings, tracks and speeds are
            `record`'s own. By default all is read from `record`: of a model with sensors from the motion of the craft
            itself, not of its antenna.

    Returns:
        Zigzag: ``overshoot_1_deg``, ``overshoot_2_deg``, …; ``initial_turning_time_s`` and ``initial_turning_L`` to 10
        deg of heading; ``period_s``, the mean time between successive extremes of heading to the same side. Turning
        circle: ``advance_L``, ``transfer_L``, ``tactical_diameter_L`` and, from a turn through 360 deg on,
        ``steady_diameter_L``, ``steady_yaw_rate_deg_s``, ``steady_drift_deg``, ``speed_loss``. Turning circle with a
        pull-out: these and ``residual_yaw_rate_deg_s``. All with ``rudder_deg`` and ``approach_speed`` [m/s]; distances
        are positive to the side turned to, drift positive with the bow into the turn, residual rate positive to that
        side. With ``phi`` the largest heel out of the turn: of a turning circle ``heel_1_deg``, with
        ``steady_heel_deg``; of a zigzag ``heel_1_deg``, …, each behind the execute of the overshoot of that number.

    Raises:
        InputError: psi or delta is missing or empty, the length is not positive, or `reference` has other times.
    """
    if not length > 0.0:
        raise InputError(f"the ship's length {length:g} m is not positive; measures need it")
    if isinstance(reference, Record):
        reference = ObservedManoeuvre.from_record(reference)
    record = own_motion(record) if reference is None else record
    if "delta" not in record and commands_of(record):
        return thrust_measures(record)
    if "psi" not in record and "phi" in record:
        return roll_measures(record)
    seen = reference.transferred_to(record) if reference else ObservedManoeuvre.from_record(record)
    return {name: value + 0.0 for name, value in _measures_of(seen, length, switching).items()}  # -0 + 0 is 0


def _measures_of(manoeuvre: ObservedManoeuvre, length: float, switching: float | None) -> dict[str, float]:
    match manoeuvre.kind:
        case ManoeuvreKind.ZIGZAG:
            return _zigzag_measures(manoeuvre, length, switching)
        case ManoeuvreKind.TURNING_CIRCLE:
            return _turning_circle_measures(manoeuvre, length)
        case ManoeuvreKind.PULL_OUT:
            return _turning_circle_measures(manoeuvre, length) | _pull_out_measures(manoeuvre)
        case _:
            return {}


def _zigzag_measures(manoeuvre: ObservedManoeuvre, length: float, switching: float | None) -> dict[str, float]:
    times, hold = list(manoeuvre.executes), manoeuvre.holds[0]
    first = Swing(manoeuvre, times[0], float(np.sign(hold.angle)))
    made = _approach_measures(manoeuvre, first, hold.angle)
    peaks = _peaks(manoeuvre)
    for k, (_, beyond) in peaks.items():
        counted = beyond if switching is None else beyond + _heading_off_course(manoeuvre, k) - abs(switching)
        made[f"overshoot_{k}_deg"] = float(np.degrees(counted))
    reached = first.time_of(INITIAL_TURN)
    if reached is not None and (len(times) < 3 or reached < times[2]):
        made["initial_turning_time_s"] = reached - times[0]
        travelled = _distance_run(manoeuvre.record, times[0], reached)
        if travelled is not None:
            made["initial_turning_L"] = travelled / length
    for k, (start, stop) in enumerate(pairwise([*times[1:], float(manoeuvre.record.time[-1])]), start=1):
        side = float(np.sign(manoeuvre.holds[k - 1].angle))
        made.update(_largest_heel(manoeuvre.record, side, start, stop, f"heel_{k}_deg"))
    periods = [peaks[k + 2][0] - at for k, (at, _) in peaks.items() if k + 2 in peaks]
    if periods:
        made["period_s"] = float(np.mean(periods))
    return made


def _approach_measures(manoeuvre: ObservedManoeuvre, swing: Swing, angle: float) -> dict[str, float]:
    made = {ORDERED_MEASURE: float(np.degrees(abs(angle)))}
    flow = speed(manoeuvre.record)
    before = None if flow is None else mean_between(manoeuvre.record, flow, swing.start - 1.0, swing.start)
    return made if before is None else {**made, "approach_speed": before}


def _peaks(manoeuvre: ObservedManoeuvre) -> dict[int, tuple[float, float]]:
    """Extremes of heading by the number of the overshoot: time [s], and angle [rad] beyond the heading at the execute.

    Overshoot k follows execute k + 1; it is absent where the ship did not turn back before the next execute.
    """
    times, record, made = manoeuvre.executes, manoeuvre.record, {}
    for k in range(1, len(times)):
        stop = times[k + 1] if k + 1 < len(times) else float(record.time[manoeuvre.holds[k].last - 1])
        side = float(np.sign(manoeuvre.holds[k - 1].angle))
        extreme = peak(record.time, side * (manoeuvre.psi - manoeuvre.psi_at(times[k])), times[k], stop)
        if extreme is not None:
            made[k] = extreme
    return made


def _heading_off_course(manoeuvre: ObservedManoeuvre, k: int) -> float:
    """Return the heading [rad] off the first course at execute k + 1, positive to the side of the hold before it."""
    return float(np.sign(manoeuvre.holds[k - 1].angle)) * (
        manoeuvre.psi_at(manoeuvre.executes[k]) - manoeuvre.psi_at(manoeuvre.executes[0])
    )


def _distance_run(record: Record, start: float, stop: float) -> float | None:
    """Return the distance run through the water (or over ground, as the velocities are) between two times [m]."""
    flow = speed(record)
    if flow is None:
        return None
    time = np.unique(np.concatenate([[start, stop], record.time[(record.time > start) & (record.time < stop)]]))
    known = np.isfinite(flow)
    values = np.interp(time, record.time[known], flow[known])
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(time)))


def _turning_circle_measures(manoeuvre: ObservedManoeuvre, length: float) -> dict[str, float]:
    hold, execute = manoeuvre.longest_hold
    swing = Swing(manoeuvre, execute, float(np.sign(hold.angle)))
    made = _approach_measures(manoeuvre, swing, hold.angle)
    quarter, half = swing.time_of(QUARTER_TURN), swing.time_of(HALF_TURN)
    at_quarter = swing.displacement(quarter) if quarter is not None else None
    at_half = swing.displacement(half) if half is not None else None
    if quarter is not None:
        made["time_90_s"] = quarter - execute
    if at_quarter is not None:
        made |= {"advance_L": at_quarter[0] / length, "transfer_L": at_quarter[1] / length}
    if at_half is not None:
        made["tactical_diameter_L"] = at_half[1] / length
    stop = float(manoeuvre.record.time[hold.last - 1])
    made |= _largest_heel(manoeuvre.record, swing.side, execute, stop, "heel_1_deg")
    return made | steady_turning(swing, stop, length, made.get("approach_speed"))


_LOBE = 0.8  # of the largest heel, down to which samples about it belong to its swing; chosen


def _largest_heel(record: Record, side: float, start: float, stop: float, name: str) -> dict[str, float]:
    """Return the largest heel out of a turn to `side` (1 starboard) between two times [s], where it is recorded."""
    rows = np.flatnonzero((record.time >= start) & (record.time <= stop))
    if "phi" not in record or not len(rows):
        return {}
    outward = -side * to_starboard(record, "phi")
    top = rows[int(np.nanargmax(outward[rows]))]
    low = rows[outward[rows] < _LOBE * outward[top]]
    before, after = low[low < top], low[low > top]
    first, last = before[-1] if len(before) else rows[0], after[0] if len(after) else rows[-1]
    swing = peak(record.time, outward, float(record.time[first]), float(record.time[last]))
    return {} if swing is None or swing[1] <= 0.0 else {name: float(np.degrees(swing[1]))}


def _pull_out_measures(manoeuvre: ObservedManoeuvre) -> dict[str, float]:
    """Return the yaw rate left when the rudder has been amidships: mean over the last tenth of that time."""
    hold, execute = manoeuvre.longest_hold
    swing = Swing(manoeuvre, execute, float(np.sign(hold.angle)))
    made = _approach_measures(manoeuvre, swing, hold.angle)
    released, stop = float(manoeuvre.record.time[hold.last - 1]), float(manoeuvre.record.time[-1])
    last = stop - _RESIDUAL_SHARE * (stop - released)
    rate = swing.side * (manoeuvre.psi_at(stop) - manoeuvre.psi_at(last)) / (stop - last)
    return {**made, "residual_yaw_rate_deg_s": float(np.degrees(rate))}
