"""Measures of runs of craft with thrusters, read from commands and motion alone: speed, turn rate, stop, overshoots.

IMO MSC.137(76) and ISO 13643-3:2017 where they define them; in metres and seconds, as such craft have no rudder and
their length says little.
"""

from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, Index, InputError, Record
from seatrial.physics.manoeuvres.track import peak

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
