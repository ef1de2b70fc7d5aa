"""A log in parts of which nothing is left out: each begins where the one before ends, or an autopilot's mode."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Record
from seatrial.data.draft.autopilot_modes import AutopilotMode
from seatrial.data.draft.stretch import LogStretch, elapsed, smooth_speed

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
