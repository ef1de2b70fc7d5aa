"""Stretches of a long log that are manoeuvres: straight runs, turns and circles, zigzags."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.signal import Mask, mask_intervals, smoothed
from seatrial.data.draft.behaviour import run_record
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.survey import LogSurvey

_STRAIGHT_S = 20.0  # s, of the shortest straight run; chosen
_STRAIGHT_HEADING = np.radians(5.0)  # rad, range of headings of a straight run; chosen
_CIRCLE, _ZIGZAG_TURNS = np.radians(270.0), 3  # rad of one turn, and turns to alternate sides; chosen
_SMALLEST_TURN, _LARGEST_ZIGZAG = np.radians(8.0), np.radians(120.0)  # rad of a turn of a zigzag; chosen
_TURNING_SHARE = 0.1  # of the largest yaw rate: beyond, the ship turns; chosen
_SMOOTHING_S = 2.0  # s over which the yaw rate is smoothed; chosen
_MOST_STRETCHES = 12  # offered; the longest


@dataclass(frozen=True)
class LogStretch:
    """A manoeuvre in a log: start and stop are s after the first sample."""

    name: str
    start: float
    stop: float
    evidence: str


def find_stretches(surveys: Sequence[LogSurvey], guesses: Sequence[Sequence[ColumnGuess]]) -> tuple[LogStretch, ...]:
    """Return the manoeuvres of a log by its heading, in order; none where it has no heading."""
    record = run_record(surveys, guesses)
    if record is None or "psi" not in record or len(record) < 30:  # samples below which nothing is a manoeuvre
        return ()
    stretches = [*_turns(record), *_straight_runs(record)]
    longest = sorted(stretches, key=lambda one: one.start - one.stop)[:_MOST_STRETCHES]
    counts: dict[str, int] = {}
    named = []
    for one in sorted(longest, key=lambda one: one.start):
        counts[one.name] = counts.get(one.name, 0) + 1
        named.append(LogStretch(f"{one.name}{counts[one.name]}", one.start, one.stop, one.evidence))
    return tuple(named)


def _turns(record: Record) -> list[LogStretch]:
    """Circles, and zigzags of turns; a turn lasts while the yaw rate is over a tenth of its largest."""
    psi, time = np.unwrap(record["psi"]), record.time - record.time[0]
    length = max(3, round(_SMOOTHING_S / record.dt)) | 1
    rate = smoothed(np.gradient(psi, record.dt), min(length, (len(psi) // 4) | 1))
    first = (len(psi) - len(rate)) // 2
    largest = float(np.max(np.abs(rate)))
    ends = sorted(end for side in (1.0, -1.0) for end in mask_intervals(side * rate > _TURNING_SHARE * largest))
    turns = [(a + first, b + first - 1, float(psi[b + first - 1] - psi[a + first])) for a, b in ends]
    turns = [turn for turn in turns if abs(turn[2]) > _SMALLEST_TURN]
    stretches = []
    for a, b, angle in turns:
        if abs(angle) > _CIRCLE:
            side = "starboard" if angle > 0 else "port"
            text = f"heading changes by {np.degrees(abs(angle)):.0f} deg to {side}"
            stretches.append(LogStretch(f"circle_{side}_", float(time[a]), float(time[b]), text))
    return stretches + _zigzags([turn for turn in turns if abs(turn[2]) < _LARGEST_ZIGZAG], time)


def _zigzags(turns: list[tuple[int, int, float]], time: Array) -> list[LogStretch]:
    """Runs of at least three turns that alternate without a pause longer than themselves."""
    chains: list[list[tuple[int, int, float]]] = []
    for turn in turns:
        follows = chains and turn[2] * chains[-1][-1][2] < 0 and turn[0] - chains[-1][-1][1] < turn[1] - turn[0]
        if follows:
            chains[-1].append(turn)
        else:
            chains.append([turn])
    stretches = []
    for chain in chains:
        if len(chain) >= _ZIGZAG_TURNS:
            angle = np.degrees(float(np.median([abs(turn[2]) for turn in chain])))
            text = f"{len(chain)} turns to alternate sides, {angle:.0f} deg each"
            stretches.append(LogStretch("zigzag", float(time[chain[0][0]]), float(time[chain[-1][1]]), text))
    return stretches


def _straight_runs(record: Record) -> list[LogStretch]:
    """Stretches over which the heading stays within five degrees while the craft moves."""
    psi, time = np.unwrap(record["psi"]), record.time - record.time[0]
    window = max(2, round(_STRAIGHT_S / record.dt))
    if len(psi) <= window:
        return []
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    spread = maximum_filter1d(psi, window) - minimum_filter1d(psi, window)
    still = spread < _STRAIGHT_HEADING
    if "u" in record:
        still &= np.abs(record["u"]) > 0.2 * np.nanmax(np.abs(record["u"]))  # of the largest speed: it moves
    half = window // 2
    return [
        LogStretch("straight", float(time[a]), float(time[b - 1]),
                   f"heading within {np.degrees(_STRAIGHT_HEADING):.0f} deg")
        for a, b in mask_intervals(_widened(still, half))
    ]  # fmt: skip


def _widened(mask: Mask, half: int) -> Mask:
    """The mask with the windows about its samples filled: stretches that overlap are one."""
    from scipy.ndimage import maximum_filter1d

    return np.asarray(maximum_filter1d(mask.astype(np.uint8), 2 * half + 1), dtype=bool)
