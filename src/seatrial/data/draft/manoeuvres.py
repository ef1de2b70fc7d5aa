"""Manoeuvres in a long log, found by heading, speed, rudder and roll; cut where the mode of an autopilot changes."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from seatrial.core.values import InputError, Record
from seatrial.data.check.approach_phase import approach_fault
from seatrial.data.draft.autopilot_modes import AutopilotMode, autopilot_modes
from seatrial.data.draft.motion_stretches import (
    DECAY,
    SHORTEST_STRAIGHT_S,
    STRAIGHT,
    decays,
    spirals,
    stops,
    straight_runs,
)
from seatrial.data.draft.stretch import MIN_SAMPLES, LogStretch
from seatrial.data.draft.survey import LogSurvey
from seatrial.data.draft.turns import turning_stretches

_FILLED = 0.7  # share of a run that its manoeuvres cover, from which on it is taken whole; chosen
_CUT_TOLERANCE = 0.1  # of a log, by which a cut into thirds moves to where a manoeuvre begins; chosen
# offered of one run; of what is on the way between manoeuvres the longest; chosen
_MOST_STRETCHES, _ON_THE_WAY = 16, frozenset({"turn", STRAIGHT})
# of a manoeuvre's time, and s at least, that its part shows of the approach: measures need the execute; chosen
_APPROACH_SHARE, _APPROACH_S = 0.1, 10.0
_FINDERS: tuple[Callable[[Record], list[LogStretch]], ...] = (turning_stretches, spirals, stops)


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
    """Return whether a run holds nothing but straight courses: what lies between them is what its rudder does."""
    return len(stretches) > 1 and all(stretch.name.startswith(STRAIGHT) for stretch in stretches)


def two_thirds_and_a_third(record: Record, stretches: Sequence[LogStretch], *, is_last: bool) -> tuple[LogStretch, ...]:
    """Return a log in two parts of which the last or the first is a third, cut where a manoeuvre begins if one does."""
    share = 2.0 / 3.0 if is_last else 1.0 / 3.0
    wanted, begins = (
        share * record.duration,
        [stretch.start for stretch in stretches if 0.0 < stretch.start < record.duration],
    )
    near = [start for start in begins if abs(start - wanted) < _CUT_TOLERANCE * record.duration]
    cut = min(near, key=lambda start: abs(start - wanted)) if near else wanted
    sizes = ("the first two thirds", "the last third") if is_last else ("the first third", "the last two thirds")
    return (
        LogStretch("first_part", 0.0, cut, f"{sizes[0]} of the log, nothing left out"),
        LogStretch("last_part", cut, record.duration, sizes[1]),
    )


def _without_straight(stretches: Sequence[LogStretch]) -> tuple[LogStretch, ...]:
    """The stretches, of which straight ones are left out where there are others."""
    is_straight = [stretch.name.startswith(STRAIGHT) for stretch in stretches]
    if all(is_straight):
        return tuple(stretches)
    return tuple(replace(one, is_left_out=out) for one, out in zip(stretches, is_straight, strict=True))


def _is_whole(record: Record, stretches: Sequence[LogStretch], count: int) -> bool:
    if len(stretches) == 1 and is_decay(stretches[0]):
        return True
    return changes_course(stretches) or (_fills(record, stretches) and (count > 1 or len(stretches) == 1))


def _fills(record: Record, stretches: Sequence[LogStretch]) -> bool:
    covered, end = 0.0, 0.0
    for stretch in sorted(stretches, key=lambda each: each.start):
        covered += max(0.0, stretch.stop - max(stretch.start, end))
        end = max(end, stretch.stop)
    return covered >= _FILLED * record.duration


def is_decay(stretch: LogStretch) -> bool:
    """Return whether a stretch is a roll decay."""
    return stretch.name.startswith(DECAY)


def _manoeuvres_of(record: Record) -> list[LogStretch]:
    if len(record) < MIN_SAMPLES:
        return []
    ordered = [one for finder in _FINDERS for one in finder(record)]
    manoeuvres = [*_with_approach(record, ordered), *decays(record)]
    return [
        *manoeuvres,
        *(part for straight_run in straight_runs(record) for part in _outside(straight_run, manoeuvres)),
    ]


def _with_approach(record: Record, manoeuvres: Sequence[LogStretch]) -> list[LogStretch]:
    """The manoeuvres from some time before their execute, as far as the record and the manoeuvre before allow.

    A pull-out gives half of its time amidships to the manoeuvre that follows it; an approach that is not steady is
    named.
    """
    stretches = list[LogStretch]()
    for manoeuvre in sorted(manoeuvres, key=lambda each: each.start):
        lead = max(_APPROACH_S, _APPROACH_SHARE * (manoeuvre.stop - manoeuvre.start))
        stretches = [_shortened(before, manoeuvre.start, lead) for before in stretches]
        free_from = max((before.stop for before in stretches), default=0.0)
        start = min(manoeuvre.start, max(manoeuvre.start - lead, free_from))
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
