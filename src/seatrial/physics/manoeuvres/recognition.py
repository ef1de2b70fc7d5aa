"""What manoeuvre a record shows: when the rudder was put over, how far, what was ordered, what the heading did."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, InputError, Record
from seatrial.core.values.arrays import Mask, mask_intervals
from seatrial.physics.manoeuvres.turns import course_of, means_of

# Motion of the craft itself in a record that was simulated by a model with sensors.

TRUE = "_true"
"""Ending of a state's channel where an instrument shows another one: at the antenna, turned by the compass, late."""


def own_motion(record: Record) -> Record:
    """Return the record with its true motion in place of what instruments show; as it is where it has none."""
    own = {name.removesuffix(TRUE): c for name, c in record.channels.items() if name.endswith(TRUE)}
    return replace(record, channels=dict(record.channels) | own) if own else record


# What manoeuvre a record shows: when the rudder was put over, how far, and what the heading did.

# the rudder is "over" beyond a quarter of the record's largest angle; a stretch is a hold if 40 % of it lies within
# 15 % of its level and it lasts a tenth of the median hold
OVER_SHARE, HOLD_TOLERANCE, HOLD_SHARE, SHORTEST_HOLD = 0.25, 0.15, 0.4, 0.1
REACH_PERCENTILE = 99.5
"""Per cent of the samples within what angles and speeds of runs reach, so that a bad one does not count; chosen."""
MINIMUM_RUDDER = float(np.radians(0.5))
# rad; a longest hold that turns the ship less is no turning circle; chosen
TURN_HEADING_CHANGE = float(np.radians(135.0))
ANGLE_TOLERANCE = 0.25  # of the common level, by which a hold may differ from it; chosen
# shares: of an angle that is amidships, of samples there that make a stop, of the largest rate that is a slew; of a
# slew from which its beginning is extrapolated; chosen
_AMIDSHIPS, _STOP, _SLEWING, _SLEW_PART = 0.1, 0.3, 0.2, (0.25, 0.75)
_REACHED = 0.95  # of the angle of the holds, at which a rudder that turns back at once was put over; chosen
_CHECKED_SHARE = 0.8  # of executes at which a zigzag's heading lies to the side steered from; chosen
# deg within which a rudder stands, and largest step between two angles of a spiral; of how long it stands at least, s
# and share of the record; angles of a spiral; s between two looks at the rudder; chosen
_HOLD_DEG, _LARGEST_STEP_DEG, _HOLD_S, _HOLD_PART, _SPIRAL_ANGLES, _LOOK_S = 1.0, 12.0, 20.0, 0.02, 5, 0.5
# stretches of rudder to one side from which on a record is a programme of random orders, not a manoeuvre; chosen
_MOST_STRETCHES = 1000
_ROWS_LOOKED_BACK = 64  # at first, for the beginning of a slew; chosen
_TIME_TOLERANCE = 1e-3  # of a sampling step, by which times may differ: rounding


class ManoeuvreKind(StrEnum):
    """What a record shows."""

    ZIGZAG = "zigzag"
    TURNING_CIRCLE = "turning-circle"
    PULL_OUT = "pull-out"
    SPIRAL = "spiral"
    OTHER = "other"


@dataclass(frozen=True)
class Hold:
    """The rudder held over: rows first..last (last excluded), its angle [rad, positive to starboard]."""

    first: int
    last: int
    angle: float


@dataclass(frozen=True, eq=False)
class ObservedManoeuvre:
    """A record's heading and rudder, unwrapped and positive to starboard, shape (n,), and the rudder's holds.

    steered_as: the run of the same rudder history whose holds, executes and kind count; None: its own.
    """

    record: Record
    psi: Array
    delta: Array
    steered_as: "ObservedManoeuvre | None" = None

    @classmethod
    def from_record(cls, record: Record) -> "ObservedManoeuvre":
        """Return the heading and rudder of a record, missing samples bridged by straight lines.

        Raises:
            InputError: channel psi or delta is missing or holds fewer than two values.
        """
        return record.computed(cls._recognised)

    @classmethod
    def _recognised(cls, record: Record) -> "ObservedManoeuvre":
        return cls(record, _heading(record), _without_gaps(record, to_starboard(record, "delta")))

    def transferred_to(self, record: Record) -> "ObservedManoeuvre":
        """Another record of the same rudder history, e.g. this run simulated: its own heading, this one's executes.

        Raises:
            InputError: its channel psi is missing or holds fewer than two values, or its times are not this one's.
        """
        time, slack = self.record.time, _TIME_TOLERANCE * self.record.dt
        if len(record) != len(time) or not np.allclose(record.time, time, rtol=0.0, atol=slack):
            raise InputError(
                f"record '{record.name}' is not sampled at the times of '{self.record.name}', at whose executes it is "
                "to be measured; resample it"
            )
        return replace(self, record=record, psi=_heading(record), steered_as=self)

    @cached_property
    def holds(self) -> tuple[Hold, ...]:
        """Flat stretches of rudder to one side, long against the others, in order; none of a thousand and more."""
        if self.steered_as is not None:
            return self.steered_as.holds
        largest = float(np.max(np.abs(self.delta)))
        if largest < MINIMUM_RUDDER:
            return ()
        level = np.where(np.abs(self.delta) > OVER_SHARE * largest, np.sign(self.delta), 0.0)
        edges = np.flatnonzero(np.diff(level)) + 1
        bounds = [0, *edges.tolist(), len(level)]
        pieces = [(a, b) for a, b in pairwise(bounds) if level[a] != 0.0]
        if len(pieces) > _MOST_STRETCHES:
            return ()
        held = {k: h for k, (a, b) in enumerate(pieces) if (h := _find_hold(self.delta, a, b)) is not None}
        if not held:
            return ()
        shortest = SHORTEST_HOLD * float(np.median([h.last - h.first for h in held.values()]))
        long = {k: h for k, h in held.items() if h.last - h.first >= max(shortest, 2.0)}
        return self._without_course_keeping([h for _, h in sorted((long | self._turned_back(pieces, long)).items())])

    def _turned_back(self, pieces: list[tuple[int, int]], holds: dict[int, Hold]) -> dict[int, Hold]:
        """Holds of a row where the rudder is put over to the other side as it arrives: 30/10 of a ship that turns fast.

        pieces: stretches of rudder to one side, first and last row; holds: of those that have one. A peak is one where
        it reaches the angle of the holds, and a hold to the other side follows.
        """
        if not holds:
            return {}
        reached = _REACHED * _median_angle(list(holds.values()))
        peaks = dict[int, Hold]()
        for k, (a, b) in enumerate(pieces):
            row = a + int(np.argmax(np.abs(self.delta[a:b])))
            angle, after = float(self.delta[row]), holds.get(k + 1)
            if k not in holds and abs(angle) >= reached and after is not None and after.angle * angle < 0.0:
                peaks[k] = Hold(row, row + 1, angle)
        return peaks

    def _without_course_keeping(self, holds: list[Hold]) -> tuple[Hold, ...]:
        """The holds from the one on that turns the craft by more than the smallest turn of its heading.

        One at the common level stays where one at that level to the other side follows: a zigzag of few degrees.
        """
        level = _median_angle(holds) if holds else 0.0
        course = course_of(self.psi)
        while len(holds) > 1 and abs(self.psi[holds[1].first] - self.psi[holds[0].first]) < course.smallest_turn:
            is_level = max(abs(abs(hold.angle) - level) for hold in holds[:2]) <= ANGLE_TOLERANCE * level
            if is_level and holds[0].angle * holds[1].angle < 0.0:
                break
            holds = holds[1:]
        return tuple(holds)

    @cached_property
    def executes(self) -> tuple[float, ...]:
        """Times [s] at which the rudder began to move to each hold: its slew between 25 and 75 % drawn back to 0 %."""
        if self.steered_as is not None:
            return self.steered_as.executes
        return tuple(self._execute_time(k) for k in range(len(self.holds)))

    def _execute_time(self, k: int) -> float:
        hold = self.holds[k]
        before = self.holds[k - 1] if k else None
        if before is not None and self._is_direct_reversal(before, hold):
            first, base = before.last - 1, before.angle
        else:
            first = self._last_row_before_slew(hold)
            base = float(self.delta[first])
        if base == hold.angle:
            return float(self.record.time[first])
        share = (self.delta[first : hold.last] - base) / (hold.angle - base)
        quarter, three = (self._crossing_time(share, first, hold.first, level) for level in _SLEW_PART)
        return max(quarter - 0.5 * (three - quarter), float(self.record.time[before.first if before else first]))

    def _is_direct_reversal(self, before: Hold, hold: Hold) -> bool:
        """Return whether the rudder went from one hold to the next without a stop amidships."""
        between = self.delta[before.last : hold.first]
        return len(between) < 2 or float(np.mean(np.abs(between) < _AMIDSHIPS * abs(hold.angle))) < _STOP

    def _last_row_before_slew(self, hold: Hold) -> int:
        """Return the last row before a hold at which the rudder had not yet begun to slew to it."""
        rates, fastest = self._rates_by_side[float(np.sign(hold.angle))]
        if not hold.first or fastest[hold.first - 1] <= 0.0:
            return 0
        slewing = _SLEWING * fastest[hold.first - 1]
        end = _last_row(rates[: hold.first], lambda values: values > slewing)
        before = _last_row(rates[: end or 0], lambda values: values <= slewing)
        return 0 if before is None else before + 1

    @cached_property
    def _rates_by_side(self) -> dict[float, tuple[Array, Array]]:
        """The rudder's change from row to row, positive to either side, and the largest one so far, (n - 1,)."""
        rates = np.diff(self.delta)
        return {side: (side * rates, np.maximum.accumulate(side * rates)) for side in (1.0, -1.0)}

    def _crossing_time(self, share: Array, first: int, hold_start: int, level: float) -> float:
        """Return the time at which `share` last rises through `level` on its way to the hold."""
        reached = hold_start - first + int(np.argmax(share[hold_start - first :] >= level))
        below = np.flatnonzero(share[: reached + 1] < level)
        row = int(below[-1]) if len(below) else 0
        a, b = float(share[row]), float(share[min(row + 1, len(share) - 1)])
        part = (level - a) / (b - a) if b > a else 0.0
        time = self.record.time[first : first + len(share)]
        return float(time[row] + min(max(part, 0.0), 1.0) * (time[min(row + 1, len(time) - 1)] - time[row]))

    @property
    def longest_hold(self) -> tuple[Hold, float]:
        """The longest hold and the time [s] of its execute."""
        k = int(np.argmax([h.last - h.first for h in self.holds]))
        return self.holds[k], self.executes[k]

    def psi_at(self, time: float) -> float:
        """Return the heading [rad], linear between samples."""
        return float(np.interp(time, self.record.time, self.psi))

    @cached_property
    def spirals(self) -> list[list[Hold]]:
        """Chains of angles at which the rudder stands, each a step further to the same side, from one side on to the
        other; looked at twice a second.

        They go on to more than half of the largest angle on both sides, and the ship turns on the way as in a circle:
        an autopilot's rudder stands at small angles while the heading stays.
        """
        time, chains = self.record.time, list[list[Hold]]()
        step = float(time[-1] - time[0]) / max(len(time) - 1, 1)
        stride = max(1, round(_LOOK_S / step)) if step > 0.0 else 1
        looks, first = np.degrees(means_of(self.delta, stride)).tolist(), 0
        least = min(_HOLD_S, _HOLD_PART * step * len(time))
        for row in range(1, len(looks) + 1):
            if row < len(looks) and abs(looks[row] - looks[first]) <= _HOLD_DEG:
                continue
            if (row - first) * stride * step >= least:
                angle = float(np.radians(np.median(looks[first:row])))
                hold = Hold(first * stride, min(row * stride, len(time)), angle)
                if chains and _is_further(chains[-1], hold):
                    chains[-1].append(hold)
                else:
                    near = chains[-1][-1:] if chains and _is_further(chains[-1][-1:], hold) else []
                    chains.append([*near, hold])
            first = row
        return [chain for chain in chains if len(chain) >= _SPIRAL_ANGLES and self._is_spiral(chain)]

    def _is_spiral(self, chain: list[Hold]) -> bool:
        largest, ends = 0.5 * float(np.max(np.abs(self.delta))), (chain[0].angle, chain[-1].angle)
        turned = float(np.sum(np.abs([self.psi[hold.last - 1] - self.psi[hold.first] for hold in chain])))
        return min(ends) < -largest and max(ends) > largest and turned >= TURN_HEADING_CHANGE

    @cached_property
    def kind(self) -> ManoeuvreKind:
        """Which manoeuvre this is, from the signs of the holds and the heading at each execute."""
        if self.steered_as is not None:
            return self.steered_as.kind
        holds, times = self.holds, self.executes
        if self.spirals:
            return ManoeuvreKind.SPIRAL
        if not holds:
            return ManoeuvreKind.OTHER
        sides = [np.sign(h.angle) for h in holds]
        if len(set(sides)) == 1:
            return self._kind_of_turn()
        if all(a != b for a, b in pairwise(sides)):
            course = self.psi_at(times[0])
            checked = [s * (self.psi_at(t) - course) < 0.0 for s, t in zip(sides[1:], times[1:], strict=True)]
            return ManoeuvreKind.ZIGZAG if np.mean(checked) >= _CHECKED_SHARE else ManoeuvreKind.OTHER
        return ManoeuvreKind.OTHER

    def _kind_of_turn(self) -> ManoeuvreKind:
        hold, execute = self.longest_hold
        if abs(self.psi[min(hold.last, len(self.psi) - 1)] - self.psi_at(execute)) < TURN_HEADING_CHANGE:
            return ManoeuvreKind.OTHER
        amidships = np.abs(self.delta[hold.last :]) < _AMIDSHIPS * abs(hold.angle)
        long = np.count_nonzero(amidships) > 0.25 * (hold.last - hold.first)
        return ManoeuvreKind.PULL_OUT if long else ManoeuvreKind.TURNING_CIRCLE


def recognise_manoeuvre(record: Record) -> ManoeuvreKind:
    """Return which manoeuvre a record shows, from its channels ``delta`` and ``psi`` alone.

    Raises:
        InputError: one of the two is missing or empty.
    """
    return ObservedManoeuvre.from_record(record).kind


def to_starboard(record: Record, symbol: str) -> Array:
    """Return values of a channel whose positive direction is starboard or port, turned to positive starboard."""
    channel = record.channel(symbol)
    if np.count_nonzero(np.isfinite(channel.values)) < 2:
        raise InputError(f"record '{record.name}': channel '{symbol}' holds fewer than two values")
    return -channel.values if channel.positive == "port" else channel.values


def _heading(record: Record) -> Array:
    """Return the heading [rad], positive to starboard, unwrapped and bridged, shape (n,)."""
    psi = to_starboard(record, "psi")
    known = np.isfinite(psi)
    return np.interp(record.time, record.time[known], np.unwrap(psi[known]))


def _without_gaps(record: Record, values: Array) -> Array:
    known = np.isfinite(values)
    return values if known.all() else np.interp(record.time, record.time[known], values[known])


def _last_row(values: Array, holds: Callable[[Array], Mask]) -> int | None:
    """Return the last row of which a condition holds, None where there is none; looks back no further than it must."""
    first, length = len(values), _ROWS_LOOKED_BACK
    while first > 0:
        last, first = first, max(0, first - length)
        rows = np.flatnonzero(holds(values[first:last]))
        if len(rows):
            return first + int(rows[-1])
        length *= 2
    return None


def _find_hold(delta: Array, first: int, last: int) -> Hold | None:
    """Return the flat part of rows first..last, or None where the rudder wanders."""
    size = np.abs(delta[first:last])
    angle = float(np.median(delta[first:last][size >= (1.0 - HOLD_TOLERANCE) * np.max(size)]))
    flat = np.abs(delta[first:last] - angle) <= HOLD_TOLERANCE * abs(angle)
    if np.mean(flat) < HOLD_SHARE:
        return None
    start, stop = max(mask_intervals(flat), key=lambda ends: ends[1] - ends[0])
    return Hold(first + start, first + stop, angle)


def _median_angle(holds: list[Hold]) -> float:
    """Return the median of the holds' angles without sign, each weighted by its length."""
    order = sorted(holds, key=lambda h: abs(h.angle))
    share = np.cumsum([h.last - h.first for h in order])
    return abs(order[int(np.searchsorted(share, 0.5 * share[-1]))].angle)


def _is_further(chain: list[Hold], hold: Hold) -> bool:
    """Whether a rudder stands a step further to the same side."""
    step, way = np.degrees(hold.angle - chain[-1].angle), chain[-1].angle - chain[0].angle
    return bool(0.0 < abs(step) <= _LARGEST_STEP_DEG and step * way >= 0.0)


# What was ordered in a zigzag, a turning circle or a pull-out, and whether another run repeats it.

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
