"""Turns by the heading: zigzags, turns, circles with or without the pull-out that follows, spins on the spot."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.data.check.signal import mask_intervals
from seatrial.data.draft.stretch import LogStretch, elapsed, padded, smooth_speed
from seatrial.physics.manoeuvres import ManoeuvreKind, ObservedManoeuvre, ordered_degrees

_CIRCLE, _ZIGZAG_TURNS = np.radians(270.0), 3  # rad of a circle, and turns of a zigzag; chosen
_SMALLEST_TURN, _LARGEST_ZIGZAG = np.radians(8.0), np.radians(120.0)  # rad of a turn of a zigzag; chosen
_TURNING_SHARE = 0.1  # of the largest yaw rate: beyond, the ship turns; chosen
# share of the log's largest speed, and m of radius, below which a craft turns on the spot; chosen: less than any circle
_SPIN_SPEED, _SPIN_RADIUS = 0.25, 0.5
_OVER, _AMIDSHIPS = 0.5, 0.1  # of the rudder's angle in a turn: put over, and amidships; as in the recognition of runs
_LULL = 0.1  # of the whole, the longest time in a turn in which the yaw rate is small; chosen
_PULL_OUT_SHARE = 0.1  # of the time of the turn that the rudder is amidships after it; chosen


@dataclass(frozen=True)
class _Turn:
    """Rows first..last of a turn and the change of heading [rad], positive to starboard."""

    first: int
    last: int
    angle: float

    @property
    def side(self) -> str:
        return "starboard" if self.angle > 0.0 else "port"


def turning_stretches(record: Record) -> list[LogStretch]:
    """Return turns, circles, spins and zigzags of a record; none without a heading.

    A turn lasts while the yaw rate is over a tenth of its largest.
    """
    if "psi" not in record:
        return []
    psi = np.unwrap(record["psi"])
    rate = padded(record, np.gradient(psi, record.dt))
    largest = float(np.max(np.abs(rate)))
    ends = sorted(end for side in (1.0, -1.0) for end in mask_intervals(side * rate > _TURNING_SHARE * largest))
    turns = [_Turn(a, b - 1, float(psi[b - 1] - psi[a])) for a, b in ends]
    turns = _joined(record, [turn for turn in turns if abs(turn.angle) > _SMALLEST_TURN])
    long = [turn for turn in turns if abs(turn.angle) > _LARGEST_ZIGZAG]
    starts = [0, *((one.last + after.first) // 2 for one, after in pairwise(long))]
    stops = [*(after.first for after in long[1:]), len(record) - 1]
    turned = [_turned(record, turn, limits) for turn, *limits in zip(long, starts, stops, strict=False)]
    return turned + _zigzags(record, [turn for turn in turns if abs(turn.angle) < _LARGEST_ZIGZAG])


def _joined(record: Record, turns: list[_Turn]) -> list[_Turn]:
    """Turns to one side that a short lull parts made one, unless the rudder was released in it."""
    joined = list[_Turn]()
    for turn in turns:
        before = joined[-1] if joined else None
        is_lull = before is not None and turn.first - before.last < _LULL * (turn.last - before.first)
        if before is not None and is_lull and before.angle * turn.angle > 0.0 and _is_held(record, before, turn):
            joined[-1] = _Turn(before.first, turn.last, before.angle + turn.angle)
        else:
            joined.append(turn)
    return joined


def _is_held(record: Record, before: _Turn, after: _Turn) -> bool:
    """Whether the rudder stands over between two turns as it did in the first; so where it is not recorded."""
    if "delta" not in record:
        return True
    delta = np.abs(record["delta"])
    return float(np.min(delta[before.last : after.first + 1])) > _OVER * float(
        np.median(delta[before.first : before.last])
    )


def _turned(record: Record, turn: _Turn, limits: list[int]) -> LogStretch:
    """A turn to one side, with what belongs to it between two rows: half way from the turn before, to the one after."""
    time, text = elapsed(record), f"heading changes by {np.degrees(abs(turn.angle)):.0f} deg to {turn.side}"
    first, last, kind = turn.first, turn.last, "turn"
    if _is_on_the_spot(record, turn):
        kind, text = "spin", f"{text} on the spot"
    elif abs(turn.angle) > _CIRCLE:
        first, last, released = _with_rudder(record, turn, limits)
        kind = "circle"
        if released is not None:
            name, text = f"circle_{turn.side}_with_pull_out_", f"{text}; then the rudder is amidships"
            return LogStretch(name, float(time[first]), float(time[last]), text, float(time[released]))
    return LogStretch(f"{kind}_{turn.side}_", float(time[first]), float(time[last]), text)


def _is_on_the_spot(record: Record, turn: _Turn) -> bool:
    flow = smooth_speed(record)
    if flow is None:
        return False
    inside = flow[turn.first : turn.last + 1]
    radius = float(np.sum(inside)) * record.dt / abs(turn.angle)
    return float(np.mean(inside)) < _SPIN_SPEED * float(np.max(flow)) or radius < _SPIN_RADIUS


def _with_rudder(record: Record, turn: _Turn, limits: list[int]) -> tuple[int, int, int | None]:
    """First and last row from the order of the rudder to the end of the pull-out, and where that begins.

    It ends with the next order, within the limits.
    """
    if "delta" not in record:
        return turn.first, turn.last, None
    delta = record["delta"] - float(np.median(record["delta"]) if _is_mostly_amidships(record) else 0.0)
    held = float(np.median(delta[turn.first : turn.last + 1]))
    over = np.abs(delta - held) < _OVER * abs(held)
    pieces = [(a, b) for a, b in mask_intervals(over) if a <= turn.last and b >= turn.first]
    if not pieces:
        return turn.first, turn.last, None
    first, released = max(min(pieces[0][0], turn.first), limits[0]), pieces[-1][1]
    small = np.abs(delta) < max(_AMIDSHIPS * abs(held), np.finfo(float).tiny)
    after = next(((a, b) for a, b in mask_intervals(small) if b > released and a <= turn.last), None)
    if after is None or after[1] - max(after[0], released) < _PULL_OUT_SHARE * (released - first):
        return first, max(turn.last, min(released - 1, limits[1])), None
    return first, min(after[1] - 1, limits[1]), max(after[0], released)


def _is_mostly_amidships(record: Record) -> bool:
    """Whether the rudder is small for most of the log: its median is then its zero."""
    delta = record["delta"]
    return bool(abs(float(np.median(delta))) < _AMIDSHIPS * float(np.max(np.abs(delta))))


def _zigzags(record: Record, turns: list[_Turn]) -> list[LogStretch]:
    """Runs of at least three turns that alternate without a pause longer than themselves."""
    chains: list[list[_Turn]] = []
    for turn in turns:
        before = chains[-1][-1] if chains else None
        if before and turn.angle * before.angle < 0 and turn.first - before.last < turn.last - turn.first:
            chains[-1].append(turn)
        else:
            chains.append([turn])
    time = elapsed(record)
    return [
        LogStretch("zigzag", float(time[chain[0].first]), float(time[chain[-1].last]), _zigzag_text(record, chain))
        for chain in chains
        if len(chain) >= _ZIGZAG_TURNS
    ]


def _zigzag_text(record: Record, chain: list[_Turn]) -> str:
    """Turns and how far the heading swings; rudder and the heading of its switches, where recorded."""
    swing = float(np.median([abs(turn.angle) for turn in chain]))
    text = f"{len(chain)} turns to alternate sides, the heading swings over {np.degrees(swing):.0f} deg"
    try:
        manoeuvre = ObservedManoeuvre.from_record(record.rows(slice(chain[0].first, chain[-1].last + 1)))
    except InputError:
        return text
    if manoeuvre.kind is not ManoeuvreKind.ZIGZAG or len(manoeuvre.executes) < _ZIGZAG_TURNS:
        return text
    rudder = float(np.median([abs(hold.angle) for hold in manoeuvre.holds]))
    psi = [manoeuvre.psi_at(execute) for execute in manoeuvre.executes[1:]]
    switched = 0.5 * float(np.median(np.abs(np.diff(psi))))
    angles = f"rudder {ordered_degrees(rudder):.0f} deg, switched at {ordered_degrees(switched):.0f} deg of heading"
    return f"{text}; {angles}"
