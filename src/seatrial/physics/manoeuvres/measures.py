"""Measures of a manoeuvre as IMO and ITTC define them, from a measured or a simulated record alike.

IMO MSC.137(76) and MSC/Circ.1053 (2002); ITTC 7.5-02-06-01 (free running model tests); ISO 13643-3:2017.
"""

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres.own_motion import own_motion
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, ObservedManoeuvre
from seatrial.physics.manoeuvres.release import roll_measures
from seatrial.physics.manoeuvres.thrust_measures import commands_of, thrust_measures
from seatrial.physics.manoeuvres.track import Swing, mean_between, peak, speed, steady_turning

QUARTER_TURN, HALF_TURN = float(np.radians(90.0)), float(np.radians(180.0))
INITIAL_TURN = float(np.radians(10.0))
ORDERED_MEASURE = "rudder_deg"
"""The measure that is the order itself: no simulation predicts it."""
_LAST_SHARE = 0.1  # of the time amidships, over which the residual rate is taken; chosen


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
        side.

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
    return made | steady_turning(swing, float(manoeuvre.record.time[hold.last - 1]), length, made.get("approach_speed"))


def _pull_out_measures(manoeuvre: ObservedManoeuvre) -> dict[str, float]:
    """Return the yaw rate left when the rudder has been amidships: mean over the last tenth of that time."""
    hold, execute = manoeuvre.longest_hold
    swing = Swing(manoeuvre, execute, float(np.sign(hold.angle)))
    made = _approach_measures(manoeuvre, swing, hold.angle)
    released, stop = float(manoeuvre.record.time[hold.last - 1]), float(manoeuvre.record.time[-1])
    last = stop - _LAST_SHARE * (stop - released)
    rate = swing.side * (manoeuvre.psi_at(stop) - manoeuvre.psi_at(last)) / (stop - last)
    return {**made, "residual_yaw_rate_deg_s": float(np.degrees(rate))}
