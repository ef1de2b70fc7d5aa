"""Stretches of a log that are manoeuvres: straight runs, turns, zigzags, circles, spirals, stops, roll decays."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Array, InputError, Record
from seatrial.core.values.arrays import mask_intervals
from seatrial.data.check.motion import smoothed
from seatrial.data.check.phases import HalfSwing, driven_swings, half_swings, is_in_waves, release_row
from seatrial.physics.manoeuvres import ManoeuvreKind, ObservedManoeuvre, ordered_degrees
from seatrial.physics.manoeuvres.track import speed
from seatrial.physics.manoeuvres.turns import Course, HeadingTurn, course_of

# A stretch of a log that is a manoeuvre, and the signals in which manoeuvres are sought.

_SMOOTHING_S = 2.0  # s over which rates and speeds are smoothed; chosen


@dataclass(frozen=True)
class LogStretch:
    """A manoeuvre in a log.

    Attributes:
        name: its kind, with the side.
        start, stop: s after the first sample.
        evidence: what shows it.
        released: s after the first sample from which on the rudder is amidships to the stop; None: it is not.
        is_left_out: whether it is offered as a run, and not used unless a person says so.
    """

    name: str
    start: float
    stop: float
    evidence: str
    released: float | None = None
    is_left_out: bool = False

    @property
    def kind(self) -> str:
        """What it is, without side and number."""
        return self.name.partition("_")[0].rstrip("0123456789")

    @property
    def kind_text(self) -> str:
        """What it is with its side, as one says it."""
        return self.name.rstrip("0123456789").rstrip("_").replace("_", " to ", 1).replace("_", " ")


def used_parts(offered: Sequence[LogStretch]) -> tuple[LogStretch, ...]:
    """Return those of the offered stretches of a run that are runs of their own."""
    return tuple(one for one in offered if not one.is_left_out)


def padded(record: Record, values: Array) -> Array:
    """Return values smoothed over two seconds, of the same length: the ends are held."""
    length = min(max(3, round(_SMOOTHING_S / record.dt)) | 1, (len(values) // 4) | 1)
    return np.pad(smoothed(values, length), length // 2, mode="edge")[: len(values)]


def elapsed(record: Record) -> Array:
    """Return the s since the first sample, shape (n,)."""
    return record.time - record.time[0]


def smooth_speed(record: Record) -> Array | None:
    """Return the smoothed speed [m/s], shape (n,); None where it is not recorded."""
    known = speed(record)
    return None if known is None else padded(record, known)


def track_velocity(record: Record) -> tuple[Array, Array]:
    """Return north and east velocity over ground [m/s] of smoothed positions, each (n,)."""
    north, east = (np.gradient(padded(record, record[one]), record.dt) for one in ("x0", "y0"))
    return north, east


# Spirals, stops and roll decays in a log.

DECAY, STRAIGHT, COURSES = "decay", "straight", "courses"  # kinds of a stretch
SHORTEST_STRAIGHT_S = 20.0  # s, of the shortest straight run; chosen
_FAST, _STOPPED = 0.7, 0.1  # of the largest speed, between which a craft stops; chosen
_FALLING = 0.9  # share of a stop's samples at which the speed falls; chosen
# half swings of a roll decay, factor by which they shrink in all, scatter of their time; chosen
_HALF_SWINGS, _SHRINKS, _PERIOD_SCATTER = 6, 2.0, 0.25
# of the first swing, by which later ones grow where slow forces disturb a decay, and no more than a tail is; chosen
_DISTURBED = 0.15
_HELD = 1.5  # of the time of the half swings that follow, beyond which the first one was held; chosen
_SMALLEST_ROLL = np.radians(2.0)  # rad, of the first swing of a decay; chosen


def spirals(record: Record) -> list[LogStretch]:
    """Return stretches in which the rudder stands at one angle after the other from one side to the other."""
    run, stretches = _steered(record), list[LogStretch]()
    for chain in run.spirals if run is not None else ():
        angles = [math.degrees(hold.angle) for hold in chain]
        text = f"rudder held at {len(chain)} angles from {angles[0]:.0f} to {angles[-1]:.0f} deg"
        stretches.append(_between(record, "spiral", (chain[0].first, chain[-1].last - 1), text))
    return stretches


def _steered(record: Record) -> ObservedManoeuvre | None:
    """What a run shows by rudder and heading; None of one without them."""
    try:
        return ObservedManoeuvre.from_record(record)
    except InputError:
        return None


def stops(record: Record) -> list[LogStretch]:
    """Return stretches in which the speed falls from most of its largest to a tenth."""
    flow, time = smooth_speed(record), elapsed(record)
    if flow is None:
        return []
    largest, stretches = float(np.max(flow)), list[LogStretch]()
    for first, _ in mask_intervals(flow < _STOPPED * largest):
        fast = np.flatnonzero(flow[:first] > _FAST * largest)
        if not fast.size:
            continue
        falling = np.diff(flow[fast[-1] : first + 1]) < 0.0
        if falling.size and np.mean(falling) > _FALLING:
            row = int(fast[-1])
            text = f"speed falls from {flow[row]:.2g} to {flow[first]:.2g} m/s, {_propulsion(record, row, first)}"
            start = float(time[_start_of_fall(flow, row)])
            stretches.append(LogStretch("stop", start, float(time[first]), text))
    return stretches


def _start_of_fall(flow: Array, row: int) -> int:
    """The last row before `row` at which the speed did not fall."""
    steady = np.flatnonzero(np.diff(flow[: row + 1]) >= 0.0)
    return int(steady[-1]) + 1 if steady.size else 0


def _propulsion(record: Record, first: int, last: int) -> str:
    names = [s for s in record.channels if s == "n" or s.startswith(("command_", "rpm_"))]
    if not names:
        return "propeller not recorded"
    is_astern = any(float(np.mean(record[name][first : last + 1])) < 0.0 for name in names)
    return "propeller astern" if is_astern else "coasting"


def decays(record: Record) -> list[LogStretch]:
    """Return stretches in which the roll swings evenly and dies out, each to where it is released anew.

    A record in waves has none: groups of swings die out in it that nobody released.
    """
    if "phi" not in record:
        return []
    phi = record["phi"] - float(np.median(record["phi"]))
    if is_in_waves(phi):
        return []
    time, stretches = elapsed(record), list[LogStretch]()
    before, chain = list[HalfSwing](), list[HalfSwing]()
    for swing in [*half_swings(phi), HalfSwing(len(phi), len(phi), np.inf)]:
        if chain and swing.angle > _smallest_level(chain) + _DISTURBED * chain[0].angle:
            even = [one for one in chain if one.angle > _DISTURBED * chain[0].angle]
            driven = max(driven_swings([*before, *even]) - len(before), 0)
            free = even[driven:]
            if _dies_out(free):
                text = f"roll swings {len(free)} half periods from {np.degrees(free[0].angle):.1f} deg down"
                start, stop = _peak(phi, free[0]) if driven else _release(phi, free), chain[-1].stop - 1
                stretches.append(LogStretch(DECAY, float(time[start]), float(time[stop]), text))
                before = []
            else:
                before += chain
            chain = []
        chain.append(swing)
    return stretches


def _peak(phi: Array, swing: HalfSwing) -> int:
    """The row of its largest angle."""
    return swing.first + int(np.argmax(np.abs(phi[swing.first : swing.stop])))


def _smallest_level(chain: Sequence[HalfSwing]) -> float:
    """The smallest angle [rad] so far that swings to both sides stayed within: one rest angle is no growth."""
    return min((max(a.angle, b.angle) for a, b in pairwise(chain)), default=chain[0].angle)


def _release(phi: Array, chain: Sequence[HalfSwing]) -> int:
    """The row of the release: of a first swing that was held, else before it, or its own where nothing shows one."""
    first = chain[0].first
    if chain[0].stop - first > _HELD * float(np.median([one.stop - one.first for one in chain[1:]])):
        return first + release_row(phi[first : chain[0].stop])
    sides = np.flatnonzero(np.diff(phi[: first + 1] >= 0.0))[:-1]
    start = int(sides[-1]) + 1 if sides.size else 0
    return start + release_row(phi[start:first]) if first > start else first


def _dies_out(chain: Sequence[HalfSwing]) -> bool:
    lengths = np.array([one.stop - one.first for one in chain[1:]], dtype=float)  # the first one may have been held
    return (
        len(chain) >= _HALF_SWINGS
        and chain[0].angle > max(_SMALLEST_ROLL, _SHRINKS * chain[-1].angle)
        and float(np.std(lengths)) < _PERIOD_SCATTER * float(np.mean(lengths))
    )


# What the heading does: zigzags, turns, circles with or without the pull-out that follows, spins on the spot, changes
# of course, and straight runs between them.

_CIRCLE, _ZIGZAG_TURNS = np.radians(270.0), 3  # rad of a circle, and turns of a zigzag; chosen
_SMALLEST_SWING, _LARGEST_SWING = np.radians(8.0), np.radians(120.0)  # rad of a turn of a zigzag; chosen
_MOVES = 0.2  # of the largest speed, above which a craft moves; chosen
# share of the log's largest speed, and m of radius, below which a craft turns on the spot; chosen: less than any circle
_SPIN_SPEED, _SPIN_RADIUS = 0.25, 0.5
_OVER, _AMIDSHIPS = 0.5, 0.1  # of the rudder's angle in a turn: put over, and amidships; as in the recognition of runs
_PULL_OUT_SHARE = 0.1  # of the time of the turn that the rudder is amidships after it; chosen
_SETTLES = 6  # time scales of the craft after a change of course that show how it settles; chosen: a steady course's


def course_stretches(record: Record) -> list[LogStretch]:
    """Return the manoeuvres that the heading shows, and straight runs on which the craft moves; none without heading.

    Turns are those at the craft's own time scale (`course_of`).
    """
    if "psi" not in record:
        return []
    course, flow = course_of(np.unwrap(record["psi"])), smooth_speed(record)
    long = [turn for turn in course.turns if abs(turn.angle) > _LARGEST_SWING]
    chains = _chains(course.turns) or _chain_of_executes(record, course)
    starts = [0, *((turn.last + after.first) // 2 for turn, after in pairwise(long))]
    stops = [*(after.first for after in long[1:]), len(record) - 1]
    rudder = _zeroed_rudder(record) if "delta" in record else None
    turned = [_turned(record, (flow, rudder), turn, limits) for turn, *limits in zip(long, starts, stops, strict=False)]
    zigzags = [_stretch(record, "zigzag", chain, _zigzag_text(record, chain)) for chain in chains]
    return [*turned, *zigzags, *_changes_of_course(record, course, chains), *_straight_runs(record, flow, course)]


def _chains(turns: Sequence[HeadingTurn]) -> list[list[HeadingTurn]]:
    """At least three turns each that alternate without a pause longer than themselves."""
    chains: list[list[HeadingTurn]] = []
    for turn in (t for t in turns if _SMALLEST_SWING < abs(t.angle) < _LARGEST_SWING):
        before = chains[-1][-1] if chains else None
        if before and turn.angle * before.angle < 0 and turn.first - before.last < turn.last - turn.first:
            chains[-1].append(turn)
        else:
            chains.append([turn])
    return [chain for chain in chains if len(chain) >= _ZIGZAG_TURNS]


def _chain_of_executes(record: Record, course: Course) -> list[list[HeadingTurn]]:
    """The turns from execute to execute of a zigzag too short for turns of the heading; none beside a steady course."""
    run = None if course.steady else _steered(record)
    if run is None or run.kind is not ManoeuvreKind.ZIGZAG:
        return []
    rows = [*np.searchsorted(record.time, run.executes).tolist(), run.holds[-1].last - 1]
    return [[HeadingTurn(a, b, float(run.psi[b] - run.psi[a])) for a, b in pairwise(rows)]]


def _changes_of_course(record: Record, course: Course, zigzags: Sequence[Sequence[HeadingTurn]]) -> list[LogStretch]:
    """What lies from the first change of a steady course to the last, between other manoeuvres."""
    groups, is_going_on = list[list[HeadingTurn]](), False
    for turn in course.turns:
        is_zigzag = any(chain[0].first <= turn.last and turn.first <= chain[-1].last for chain in zigzags)
        is_change = abs(turn.angle) <= _LARGEST_SWING and not is_zigzag and course.steady
        if is_change and is_going_on:
            groups[-1].append(turn)
        elif is_change:
            groups.append([turn])
        is_going_on = is_change
    stretches = []
    for group in groups:
        angles = sorted(np.degrees(abs(turn.angle)) for turn in group)
        sizes = f"{angles[0]:.0f} to {angles[-1]:.0f}" if len(group) > 1 else f"{angles[0]:.0f}"
        text = f"{counted(len(group), 'change')} of course by {sizes} deg"
        after = min((t.first for t in course.turns if t.first > group[-1].last), default=len(record) - 1)
        settled = HeadingTurn(group[-1].first, min(group[-1].last + _SETTLES * course.scale, after), group[-1].angle)
        stretches.append(_stretch(record, COURSES, [*group, settled], text))
    return stretches


def _straight_runs(record: Record, flow: Array | None, course: Course) -> list[LogStretch]:
    """Steady courses on which the craft moves."""
    rows = np.zeros(len(record), dtype=bool)
    for a, b in course.steady:
        rows[a:b] = True
    if flow is not None:
        rows &= flow > _MOVES * np.max(flow)
    psi = np.unwrap(record["psi"])
    return [
        _between(record, STRAIGHT, (a, b - 1), f"heading within {np.degrees(np.ptp(psi[a:b])):.2g} deg")
        for a, b in mask_intervals(rows)
        if record.time[b - 1] - record.time[a] >= SHORTEST_STRAIGHT_S
    ]


def _stretch(record: Record, name: str, turns: Sequence[HeadingTurn], text: str) -> LogStretch:
    return _between(record, name, (turns[0].first, turns[-1].last), text)


def _turned(
    record: Record, signals: tuple[Array | None, Array | None], turn: HeadingTurn, limits: list[int]
) -> LogStretch:  # fmt: skip
    """A turn to one side, with what belongs to it between two rows: half way from the turn before, to the one after.

    signals: speed and rudder.
    """
    text = f"heading changes by {np.degrees(abs(turn.angle)):.0f} deg to {turn.side}"
    first, last, kind, (flow, rudder) = turn.first, turn.last, "turn", signals
    if flow is not None and _is_on_the_spot(flow, record.dt, turn):
        kind, text = "spin", f"{text} on the spot"
    elif abs(turn.angle) > _CIRCLE:
        kind = "circle"
        first, last, released = (first, last, None) if rudder is None else _with_rudder(rudder, turn, limits)
        if released is not None:
            name, text = f"circle_{turn.side}_with_pull_out_", f"{text}; then the rudder is amidships"
            return replace(_between(record, name, (first, last), text), released=_second(record, released))
    return _between(record, f"{kind}_{turn.side}_", (first, last), text)


def _between(record: Record, name: str, rows: tuple[int, int], text: str) -> LogStretch:
    return LogStretch(name, _second(record, rows[0]), _second(record, rows[1]), text)


def _second(record: Record, row: int) -> float:
    return float(record.time[row] - record.time[0])


def _is_on_the_spot(flow: Array, dt: float, turn: HeadingTurn) -> bool:
    inside = flow[turn.first : turn.last + 1]
    radius = float(np.sum(inside)) * dt / abs(turn.angle)
    return float(np.mean(inside)) < _SPIN_SPEED * float(np.max(flow)) or radius < _SPIN_RADIUS


def _with_rudder(rudder: Array, turn: HeadingTurn, limits: list[int]) -> tuple[int, int, int | None]:
    """First and last row from the order of the rudder to the end of the pull-out, and where that begins.

    It ends with the next order, within the limits.
    """
    origin, end = min(limits[0], turn.first), max(limits[1], turn.last)
    delta, begun, ended = rudder[origin : end + 1], turn.first - origin, turn.last - origin
    held = float(np.median(delta[begun : ended + 1]))
    pieces = [(a, b) for a, b in mask_intervals(np.abs(delta - held) < _OVER * abs(held)) if a <= ended and b >= begun]
    if not pieces:
        return turn.first, turn.last, None
    first, released = min(pieces[0][0], begun), pieces[-1][1]
    small = np.abs(delta) < max(_AMIDSHIPS * abs(held), np.finfo(float).tiny)
    after = next(((a, b) for a, b in mask_intervals(small) if b > released and a <= ended), None)
    if after is None or after[1] - max(after[0], released) < _PULL_OUT_SHARE * (released - first):
        return origin + first, origin + max(ended, released - 1), None
    return origin + first, origin + after[1] - 1, origin + max(after[0], released)


def _zeroed_rudder(record: Record) -> Array:
    """The rudder; about its median where it is small for most of the log: that is then its zero."""
    delta = record["delta"]
    median = float(np.median(delta))
    return delta - median if abs(median) < _AMIDSHIPS * float(np.max(np.abs(delta))) else delta


def _zigzag_text(record: Record, chain: Sequence[HeadingTurn]) -> str:
    """Turns and how far the heading swings; rudder and the heading of its switches, where recorded."""
    swing = float(np.median([abs(turn.angle) for turn in chain]))
    text = f"{len(chain)} turns to alternate sides, the heading swings over {np.degrees(swing):.0f} deg"
    manoeuvre = _steered(record.rows(slice(chain[0].first, chain[-1].last + 1)))
    if manoeuvre is None or manoeuvre.kind is not ManoeuvreKind.ZIGZAG or len(manoeuvre.executes) < _ZIGZAG_TURNS:
        return text
    rudder = float(np.median([abs(hold.angle) for hold in manoeuvre.holds]))
    psi = [manoeuvre.psi_at(execute) for execute in manoeuvre.executes[1:]]
    switched = 0.5 * float(np.median(np.abs(np.diff(psi))))
    angles = f"rudder {ordered_degrees(rudder):.0f} deg, switched at {ordered_degrees(switched):.0f} deg of heading"
    return f"{text}; {angles}"


# A run whose file is called after another manoeuvre than the one that it shows.

# what files are called -> the kinds of stretches that fit
_NAMED: Mapping[str, tuple[str, ...]] = {
    r"zig_?-? ?zag|zz": ("zigzag",),
    r"circle|turning": ("circle", "turn", "spin"),
    r"spiral": ("spiral",),
    r"decay": ("decay",),
}


def name_contradiction(name: str, stretches: Sequence[LogStretch]) -> str:
    """Return what the name of a run says that its motion does not show; empty where they agree, or it says nothing.

    stretches: the manoeuvres in the run, with their evidence.
    """
    named = [kinds for word, kinds in _NAMED.items() if re.search(rf"(?<![a-z])({word})(?![a-z])", name, re.IGNORECASE)]
    shown = [stretch for stretch in stretches if not stretch.name.startswith(("straight", "stop"))]
    if len(named) != 1 or not shown or any(one.name.startswith(named[0]) for one in shown):
        return ""
    return f"the name says {named[0][0]}, the motion does not: {shown[0].evidence}"
