"""Manoeuvres in a long log, cut where the mode of an autopilot changes; a log in parts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.data.check.motion import MIN_SAMPLES
from seatrial.data.check.phases import approach_fault
from seatrial.data.draft.stretches import (
    COURSES,
    DECAY,
    SHORTEST_STRAIGHT_S,
    STRAIGHT,
    LogStretch,
    course_stretches,
    decays,
    elapsed,
    smooth_speed,
    spirals,
    stops,
)
from seatrial.data.draft.survey import LogSurvey
from seatrial.physics.manoeuvres.turns import course_of

# Modes of an autopilot in a log: when each began, and whether a controller was on.

# PX4, msg/VehicleStatus.msg: number of a navigation state -> its name
_PX4_STATES = {0: "MANUAL", 1: "ALTCTL", 2: "POSCTL", 3: "AUTO", 4: "LOITER", 5: "RTL", 10: "ACRO", 14: "OFFBOARD",
               15: "STABILIZED", 17: "TAKEOFF", 18: "LAND"}  # fmt: skip
_WITHOUT_CONTROLLER = ("MANUAL", "INITIALISING")


@dataclass(frozen=True)
class AutopilotMode:
    """A mode of the autopilot: start and stop on the clock of the log [s]."""

    name: str
    start: float
    stop: float

    @property
    def text(self) -> str:
        """What it means for an estimate."""
        if self.name in _WITHOUT_CONTROLLER:
            return f"mode {self.name}: no controller"
        return f"mode {self.name}: a controller is on, its orders follow the motion"


def autopilot_modes(surveys: Sequence[LogSurvey], record: Record) -> list[AutopilotMode]:
    """Return the modes during a record, in order, the same one after itself joined; empty: the log has none."""
    events = sorted(
        (event.time, _mode_name(event.name))
        for survey in surveys
        for event in survey.log.events
        if _mode_name(event.name)
    )
    start, end = float(record.time[0]), float(record.time[-1])
    pairs = pairwise([*events, (end, "")])
    modes = [AutopilotMode(name, max(time, start), min(stop, end)) for (time, name), (stop, _) in pairs]
    joined = list[AutopilotMode]()
    for mode in modes:
        if mode.stop - mode.start <= 0.0:
            continue
        if joined and joined[-1].name == mode.name:
            joined[-1] = replace(joined[-1], stop=mode.stop)
        else:
            joined.append(mode)
    return joined


def _mode_name(event: str) -> str:
    """The name of a mode; empty for another event."""
    kind, _, name = event.partition(" ")
    if kind == "nav_state" and name.isdecimal():
        return _PX4_STATES.get(int(name), name)
    return name if kind == "MODE" else ""


# Manoeuvres in a long log, found by heading, speed, rudder and roll; cut where the mode of an autopilot changes.

_FILLED = 0.7  # share of a run that its manoeuvres cover, from which on it is taken whole; chosen
_CUT_TOLERANCE = 0.1  # of a log, by which a cut into thirds moves to where a manoeuvre begins; chosen
# offered of one run; of what is on the way between manoeuvres the longest; chosen
_MOST_STRETCHES, _ON_THE_WAY = 16, frozenset({"turn", COURSES, STRAIGHT})
# of a manoeuvre's time, and s at least, that its part shows of the approach: measures need the execute; chosen
_APPROACH_SHARE, _APPROACH_S = 0.1, 10.0


def find_stretches(surveys: Sequence[LogSurvey], record: Record | None) -> tuple[LogStretch, ...]:
    """Return the manoeuvres of the record of one run in order, those of the same kind under the same name.

    Zigzags, circles with or without pull-out, spins, spirals, straight runs, stops and roll decays; where the log has
    modes, each stretch lies within one, and modes without a manoeuvre are offered as a whole.
    """
    if record is None:
        return ()
    modes = autopilot_modes(surveys, record)
    stretches = [one for mode in modes for one in _in_mode(record, mode)] if modes else _manoeuvres_of(record)
    ranked = sorted(stretches, key=lambda stretch: (stretch.kind in _ON_THE_WAY, stretch.start - stretch.stop))
    return tuple(sorted(ranked[:_MOST_STRETCHES], key=lambda one: one.start))


def numbered(runs: Sequence[Sequence[LogStretch]]) -> tuple[tuple[LogStretch, ...], ...]:
    """Return the stretches of several runs with names that differ: ``zigzag1``, ``zigzag2``."""
    counts: dict[str, int] = {}
    result = []
    for run in runs:
        named = []
        for one in run:
            counts[one.name] = counts.get(one.name, 0) + 1
            named.append(replace(one, name=f"{one.name}{counts[one.name]}"))
        result.append(tuple(named))
    return tuple(result)


def offered_parts(
    records: Sequence[Record | None], stretches: Sequence[Sequence[LogStretch]]
) -> tuple[tuple[LogStretch, ...], ...]:
    """Return the stretches of each run that are offered as runs of their own; empty where the run stays whole.

    Straight ones are left out where there are others. A run stays whole where it is one roll decay, where manoeuvres
    fill it and it is one of several runs or holds but one, and where it changes from one straight course to the next.
    """
    return tuple(
        () if record is not None and _is_whole(record, run, len(records)) else _without_straight(run)
        for record, run in zip(records, stretches, strict=True)
    )


def changes_course(stretches: Sequence[LogStretch]) -> bool:
    """Return whether a run holds nothing but straight courses and the changes from one to the next."""
    kinds = {stretch.kind for stretch in stretches}
    return COURSES in kinds and kinds <= {COURSES, STRAIGHT}


def two_thirds_and_a_third(record: Record, stretches: Sequence[LogStretch], *, is_last: bool) -> tuple[LogStretch, ...]:
    """Return a log in two parts of which the last or the first has a third of what lies between straight runs.

    It is cut where a manoeuvre begins or amid a steady course if there is one near, and nothing is left out.
    """
    excited = [one for one in stretches if one.kind != STRAIGHT]
    first = min((one.start for one in excited), default=0.0)
    last = max((one.stop for one in excited), default=record.duration)
    wanted = first + (2.0 if is_last else 1.0) / 3.0 * (last - first)
    steady = course_of(np.unwrap(record["psi"])).steady if "psi" in record else ()
    calm = [one.start for one in stretches if 0.0 < one.start < record.duration]
    calm += [float(elapsed(record)[(a + b) // 2]) for a, b in steady]
    near = [second for second in calm if abs(second - wanted) < _CUT_TOLERANCE * record.duration]
    cut = min(near, key=lambda second: abs(second - wanted), default=wanted)
    sizes = ("the first two thirds", "the last third") if is_last else ("the first third", "the last two thirds")
    return (
        LogStretch("first_part", 0.0, cut, f"{sizes[0]} of the manoeuvres, nothing left out"),
        LogStretch("last_part", cut, record.duration, sizes[1]),
    )


def _without_straight(stretches: Sequence[LogStretch]) -> tuple[LogStretch, ...]:
    """The stretches, of which straight ones are left out where there are others."""
    is_straight = [stretch.name.startswith(STRAIGHT) for stretch in stretches]
    if all(is_straight):
        return tuple(stretches)
    return tuple(replace(one, is_left_out=out) for one, out in zip(stretches, is_straight, strict=True))


def _is_whole(record: Record, stretches: Sequence[LogStretch], count: int) -> bool:
    if len(stretches) == 1 and stretches[0].kind == DECAY:
        return True
    return changes_course(stretches) or (_fills(record, stretches) and (count > 1 or len(stretches) == 1))


def _fills(record: Record, stretches: Sequence[LogStretch]) -> bool:
    covered, end = 0.0, 0.0
    for stretch in sorted(stretches, key=lambda each: each.start):
        covered += max(0.0, stretch.stop - max(stretch.start, end))
        end = max(end, stretch.stop)
    return covered >= _FILLED * record.duration


def _manoeuvres_of(record: Record) -> list[LogStretch]:
    if len(record) < MIN_SAMPLES:
        return []
    by_heading = course_stretches(record)
    ordered = [*(part for part in by_heading if part.kind != STRAIGHT), *spirals(record), *stops(record)]
    manoeuvres = [*_with_approach(record, ordered), *decays(record)]
    straight = [part for part in by_heading if part.kind == STRAIGHT]
    return [*manoeuvres, *(part for run in straight for part in _outside(run, manoeuvres))]


def _with_approach(record: Record, manoeuvres: Sequence[LogStretch]) -> list[LogStretch]:
    """The manoeuvres from some time before their execute, as far as the record and the manoeuvre before allow.

    A pull-out gives half of its time amidships to the manoeuvre that follows it; an approach that is not steady is
    named. None shares time with another: what is held out would be fitted, too.
    """
    stretches = list[LogStretch]()
    for manoeuvre in sorted(manoeuvres, key=lambda each: each.start):
        lead = max(_APPROACH_S, _APPROACH_SHARE * (manoeuvre.stop - manoeuvre.start))
        stretches = [_shortened(before, manoeuvre.start, lead) for before in stretches]
        free_from = max((before.stop for before in stretches), default=0.0)
        if manoeuvre.stop <= free_from:
            continue
        start = max(manoeuvre.start - lead, free_from)
        stretches.append(
            replace(manoeuvre, start=start, evidence=f"{manoeuvre.evidence}{_approach_text(record, manoeuvre, lead)}")
        )
    return stretches


def _shortened(before: LogStretch, execute: float, lead: float) -> LogStretch:
    """A manoeuvre that leaves the next one, whose execute is given, up to `lead` s of its pull-out."""
    if before.released is None or not before.released < execute:
        return before
    return replace(before, stop=min(before.stop, max(execute - lead, 0.5 * (before.released + execute))))


def _approach_text(record: Record, one: LogStretch, lead: float) -> str:
    """What is wrong with the approach, as it follows upon the evidence; looked at in the log, beyond the part."""
    origin = float(record.time[0])
    try:
        fault = approach_fault(record.between(origin + max(0.0, one.start - lead), origin + one.stop))
    except InputError:
        return ""
    return f"; no steady approach: {fault}" if fault else ""


def _outside(straight: LogStretch, manoeuvres: Sequence[LogStretch]) -> list[LogStretch]:
    """What of a straight run lies in no manoeuvre, where it is long enough to be one."""
    pieces = [straight]
    for manoeuvre in manoeuvres:
        cut = [
            replace(piece, start=start, stop=stop)
            for piece in pieces
            for start, stop in (
                (piece.start, min(piece.stop, manoeuvre.start)),
                (max(piece.start, manoeuvre.stop), piece.stop),
            )
        ]
        pieces = [piece for piece in cut if piece.stop - piece.start >= SHORTEST_STRAIGHT_S]
    return pieces


def _in_mode(record: Record, mode: AutopilotMode) -> list[LogStretch]:
    """The manoeuvres within a mode; the mode itself where there are none and it lasts."""
    try:
        part = record.between(mode.start, mode.stop)
    except InputError:
        return []
    offset = float(part.time[0] - record.time[0])
    found = [
        replace(one, start=one.start + offset, stop=one.stop + offset, evidence=f"{one.evidence}; {mode.text}")
        for one in _manoeuvres_of(part)
    ]
    if found or part.duration < SHORTEST_STRAIGHT_S:
        return found
    return [LogStretch(f"{mode.name.lower()}_", offset, offset + part.duration, mode.text)]


# A log in parts of which nothing is left out: each begins where the one before ends, or an autopilot's mode.

_SHORTEST_S = 10.0  # s of the shortest part without a manoeuvre; chosen: a craft with thrusters settles within them
_AT_REST_S = 10.0  # s at rest that are kept before a craft first moves, and after it last does; chosen
_MOVES = 0.05  # of the largest speed, above which a craft moves; as for the rest of its commands
_BETWEEN = "between"  # how a part without a manoeuvre is called; ours


@dataclass(frozen=True)
class _Region:
    """A time over whose ends no part extends, s after the first sample, and what it means for an estimate."""

    start: float
    stop: float
    note: str


def parts_without_gaps(
    record: Record, stretches: Sequence[LogStretch], modes: Sequence[AutopilotMode]
) -> tuple[LogStretch, ...]:
    """Return the stretches of a log widened to what lies between them, but for long rest at its beginning and end.

    What lies before a stretch becomes its beginning where it is no longer than that, else a part of its own.

    Args:
        record: of the log.
        stretches: found in it, in order.
        modes: of an autopilot, in order, over whose ends no part extends; empty: the log has none.
    """
    parts = [part for region in _regions(record, modes) for part in _parts(region, stretches)]
    count = 0
    named = list[LogStretch]()
    for part in parts:
        count += part.name == _BETWEEN
        named.append(replace(part, name=f"{_BETWEEN}_{count}") if part.name == _BETWEEN else part)
    return tuple(named)


def _regions(record: Record, modes: Sequence[AutopilotMode]) -> list[_Region]:
    """The modes while a craft moves, the first one from the start of the log; else all of that time."""
    begin, end = _moving(record)
    if not modes:
        return [_Region(begin, end, "")]
    origin = float(record.time[0])
    starts = [begin, *(max(mode.start - origin, begin) for mode in modes[1:]), end]
    clipped = zip(modes, pairwise(starts), strict=True)
    return [_Region(start, min(stop, end), f"; {one.text}") for one, (start, stop) in clipped if start < min(stop, end)]


def _parts(region: _Region, stretches: Sequence[LogStretch]) -> list[LogStretch]:
    """The parts of a region; none where it is short and nothing is found in it."""
    parts, reached = list[LogStretch](), region.start
    for stretch in stretches:
        first, last = max(stretch.start, reached), min(stretch.stop, region.stop)
        if last <= first:
            continue
        if _is_part(first - reached, last - first):
            parts.append(_between(reached, first, region.note))
            reached = first
        parts.append(replace(stretch, start=reached, stop=last))
        reached = last
    rest = region.stop - reached
    if not parts or _is_part(rest, parts[-1].stop - parts[-1].start):
        return [*parts, _between(reached, region.stop, region.note)] if _is_part(rest, 0.0) else parts
    return [*parts[:-1], replace(parts[-1], stop=region.stop)]


def _is_part(seconds: float, neighbour: float) -> bool:
    """Whether a time without a manoeuvre is a part of its own, beside a stretch that takes some seconds."""
    return seconds > max(neighbour, _SHORTEST_S)


def _between(start: float, stop: float, note: str) -> LogStretch:
    return LogStretch(_BETWEEN, start, stop, f"no manoeuvre is recognised in it{note}")


def _moving(record: Record) -> tuple[float, float]:
    """From shortly before a craft first moves to shortly after it last does, s after the first sample."""
    flow, time = smooth_speed(record), elapsed(record)
    if flow is None or not np.max(flow) > 0.0:
        return 0.0, record.duration
    rows = np.flatnonzero(flow > _MOVES * np.max(flow))
    return max(0.0, float(time[rows[0]]) - _AT_REST_S), min(record.duration, float(time[rows[-1]]) + _AT_REST_S)
