"""Track and speed of a record: position, speed, and the time at which the heading has changed by an angle."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record, RecordKind
from seatrial.numerics.local_polynomials import smoothed_locally
from seatrial.physics.manoeuvres.recognition import ObservedManoeuvre, to_starboard

_TURN_TOLERANCE = 1e-3  # rad by which a full turn may fall short: rounding

PEAK_HALF_WIDTH = 0.04  # of the swing's samples, over which its peak is fitted; chosen
_FEWEST_SAMPLES = 5  # of a swing that has a peak; chosen
# a speed from positions: its standard deviation as a share of the typical one; samples of the narrowest window, which
# a parabola does not pass through; stretches of a run over which the typical speed is taken; chosen
_SPEED_ERROR, _NARROWEST, _STRETCHES = 0.01, 5, 20


@dataclass(frozen=True, eq=False)
class Swing:
    """A heading change to one side from the time of an execute.

    Attributes:
        manoeuvre: the record with its executes.
        start: time of the execute [s].
        side: +1 to starboard, -1 to port.
    """

    manoeuvre: ObservedManoeuvre
    start: float
    side: float

    def time_of(self, change: float) -> float | None:
        """Return the first time [s] at which the heading has changed by `change` [rad] to this side, or None."""
        time = self.manoeuvre.record.time
        deviation = self.side * (self.manoeuvre.psi - self.manoeuvre.psi_at(self.start)) - change
        rows = np.flatnonzero((deviation >= 0.0) & (time >= self.start))
        if not len(rows):
            return None
        row = int(rows[0])
        if row == 0 or time[row - 1] < self.start:
            return float(time[row])
        a, b = float(deviation[row - 1]), float(deviation[row])
        return float(time[row - 1] - a / (b - a) * (time[row] - time[row - 1])) if b > a else float(time[row])

    def displacement(self, time: float) -> tuple[float, float] | None:
        """Distance along the original course and across it to this side [m] since the execute; None without a track.

        The course is the heading at the execute (MSC.137(76), definitions 4.2.3 and 4.2.4).
        """
        record = self.manoeuvre.record
        if not has_track(record):
            return None
        known = np.isfinite(record["x0"]) & np.isfinite(record["y0"])
        when = (self.start, time)
        dx, dy = (float(np.diff(np.interp(when, record.time[known], record[s][known]))[0]) for s in ("x0", "y0"))
        course = self.manoeuvre.psi_at(self.start)
        along = dx * np.cos(course) + dy * np.sin(course)
        across = -dx * np.sin(course) + dy * np.cos(course)
        return float(along), float(self.side * across)


def has_track(record: Record) -> bool:
    """Return whether the record shows where the craft went: a position that moves, not that of a model without surge.

    A model of steering alone (Nomoto) keeps its speed, or stays where it is; its distances are no prediction.
    """
    if not {"x0", "y0"} <= set(record.channels) or (record.kind is RecordKind.SIMULATED and "u" not in record):
        return False
    known = np.isfinite(record["x0"]) & np.isfinite(record["y0"])
    return bool(known.any()) and any(np.ptp(record[s][known]) > 0.0 for s in ("x0", "y0"))


def speed(record: Record) -> Array | None:
    """Speed [m/s] over the samples, shape (n,), or None.

    From u and v (through water or over ground, as recorded); without u from the positions, over ground.
    """
    if "u" not in record:
        return _speed_of_track(record) if has_track(record) else None
    sway = record["v"] if "v" in record else np.zeros(len(record))
    return np.hypot(record["u"], sway)


def _speed_of_track(record: Record) -> Array | None:
    """Speed [m/s] from positions: slope of parabolas over as many samples as their noise calls for, shape (n,)."""
    known = np.isfinite(record["x0"]) & np.isfinite(record["y0"])
    count = len(record)
    if np.count_nonzero(known) < count // 2 or count < _NARROWEST:
        return None
    even = np.linspace(record.time[0], record.time[-1], count)
    place = np.column_stack([np.interp(even, record.time[known], record[s][known]) for s in ("x0", "y0")])
    step = float(even[1] - even[0])
    width = _slope_window(place, step)
    if width > count:
        return None
    velocity = smoothed_locally(place, width, 2, derivative=1, step=step)
    return np.interp(record.time, even, np.hypot(velocity[:, 0], velocity[:, 1]))


def _slope_window(place: Array, step: float) -> int:
    """Samples, odd, over which a line's slope is known to a share of the typical speed; place: (n, 2) [m].

    The standard deviation of a slope over n samples is sigma sqrt(12 / n^3) / step; sigma from third differences, whose
    variance is 20 sigma^2.
    """
    noise = float(np.std(np.diff(place, 3, axis=0)) / np.sqrt(20.0))  # 1 + 9 + 9 + 1: squares of their weights
    apart = max(1, len(place) // _STRETCHES)
    typical = float(np.median(np.hypot(*(place[apart:] - place[:-apart]).T))) / (apart * step)
    if not typical > 0.0:
        return len(place) + 1
    samples = np.cbrt(12.0 * (noise / (_SPEED_ERROR * typical * step)) ** 2)  # 12: as above, solved for n
    return max(_NARROWEST, 2 * int(np.ceil(0.5 * (samples - 1.0))) + 1)


def mean_between(record: Record, values: Array, start: float, stop: float) -> float | None:
    """Return the mean of the finite values with start <= t <= stop, or the nearest sample's, or None."""
    inside = (record.time >= start) & (record.time <= stop) & np.isfinite(values)
    if inside.any():
        return float(np.mean(values[inside]))
    nearest = float(values[int(np.argmin(np.abs(record.time - start)))])
    return nearest if np.isfinite(nearest) else None


def steady_turning(swing: Swing, stop: float, length: float, approach: float | None) -> dict[str, float]:
    """Steady turning measures over the last 180 deg of heading before `stop` [s]; none before 360 deg are turned.

    Yaw rate [deg/s], drift [deg] (positive with the bow into the turn), final diameter 2 U / r [L], loss of speed;
    heel [deg], positive out of the turn.
    """
    turned = swing.side * (swing.manoeuvre.psi_at(stop) - swing.manoeuvre.psi_at(swing.start))
    begin = swing.time_of(turned - np.pi)
    if turned < 2.0 * np.pi - _TURN_TOLERANCE or begin is None:
        return {}
    record = swing.manoeuvre.record
    rate = np.pi / (stop - begin)
    made = {"steady_yaw_rate_deg_s": float(np.degrees(rate))}
    heel = mean_between(record, -swing.side * to_starboard(record, "phi"), begin, stop) if "phi" in record else None
    if heel is not None:
        made["steady_heel_deg"] = float(np.degrees(heel))
    flow = speed(record)
    mean = None if flow is None else mean_between(record, flow, begin, stop)
    if mean is None:
        return made
    made["steady_diameter_L"] = 2.0 * mean / rate / length
    if approach:
        made["speed_loss"] = 1.0 - mean / approach
    if "v" in record:
        drift = mean_between(record, -swing.side * np.arctan2(record["v"], record["u"]), begin, stop)
        if drift is not None:
            made["steady_drift_deg"] = float(np.degrees(drift))
    return made


def peak(time: Array, heading: Array, start: float, stop: float) -> tuple[float, float] | None:
    """Return time and size of the largest heading between two times, by a parabola; None where it lies at the end."""
    rows = np.flatnonzero((time >= start) & (time <= stop))
    if len(rows) < _FEWEST_SAMPLES:
        return None
    top = int(np.argmax(heading[rows]))
    half = max(2, round(PEAK_HALF_WIDTH * len(rows)))
    if top + half >= len(rows):
        return None
    about, highest = rows[max(top - half, 0) : top + half + 1], rows[top]
    sampled = float(time[highest]), float(heading[highest])
    if len(about) < 4:
        return sampled
    t = time[about] - time[highest]
    scale = float(np.max(np.abs(t)))
    columns = np.vander(t / scale, 3, increasing=True)
    c, b, a = np.linalg.lstsq(columns, heading[about], rcond=None)[0] / scale ** np.arange(3)
    at = -b / (2.0 * a) if a < 0.0 else 0.0
    return (sampled[0] + float(at), float(c + at * (b + at * a))) if t[0] <= at <= t[-1] else sampled
