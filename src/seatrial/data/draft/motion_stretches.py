"""Straight runs, spirals, stops and roll decays in a log."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.roll_release import HalfSwing, driven_swings, half_swings, is_in_waves, release_row
from seatrial.data.check.signal import Mask, mask_intervals
from seatrial.data.draft.stretch import LogStretch, elapsed, padded, smooth_speed

DECAY, STRAIGHT = "decay", "straight"  # kinds of a stretch
SHORTEST_STRAIGHT_S = 20.0  # s, of the shortest straight run; chosen
_STRAIGHT_HEADING = np.radians(5.0)  # rad, range of headings of a straight run; chosen
_MOVES = 0.2  # of the largest speed, above which a craft moves; chosen
# deg within which a rudder is held, and largest step between two holds; s of a hold; holds of a spiral; chosen
_HOLD_DEG, _LARGEST_STEP_DEG, _HOLD_S, _SPIRAL_HOLDS = 1.0, 12.0, 20.0, 5
_FAST, _STOPPED = 0.7, 0.1  # of the largest speed, between which a craft stops; chosen
_FALLING = 0.9  # share of a stop's samples at which the speed falls; chosen
_LOOK_S = 0.5  # s between two looks at the rudder; chosen: short against a hold
# half swings of a roll decay, factor by which they shrink in all, scatter of their time; chosen
_HALF_SWINGS, _SHRINKS, _PERIOD_SCATTER = 6, 2.0, 0.25
# of the first swing, by which later ones grow where slow forces disturb a decay, and no more than a tail is; chosen
_DISTURBED = 0.15
_HELD = 1.5  # of the time of the half swings that follow, beyond which the first one was held; chosen
_SMALLEST_ROLL = np.radians(2.0)  # rad, of the first swing of a decay; chosen


def straight_runs(record: Record) -> list[LogStretch]:
    """Return stretches over which the heading stays within five degrees while the craft moves."""
    window = max(2, round(SHORTEST_STRAIGHT_S / record.dt))
    if "psi" not in record or len(record) <= window:
        return []
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    psi, time = np.unwrap(record["psi"]), elapsed(record)
    even = maximum_filter1d(psi, window) - minimum_filter1d(psi, window) < _STRAIGHT_HEADING
    flow = smooth_speed(record)
    if flow is not None:
        even &= flow > _MOVES * np.max(flow)
    text = f"heading within {np.degrees(_STRAIGHT_HEADING):.0f} deg"
    ends = mask_intervals(_widened(even, window // 2))
    return [LogStretch(STRAIGHT, float(time[a]), float(time[b - 1]), text) for a, b in ends]


def _widened(mask: Mask, half: int) -> Mask:
    """The mask with the windows about its samples filled: stretches that overlap are one."""
    from scipy.ndimage import maximum_filter1d

    return np.asarray(maximum_filter1d(mask.astype(np.uint8), 2 * half + 1), dtype=bool)


def spirals(record: Record) -> list[LogStretch]:
    """Return stretches in which the rudder stands at one angle after the other from one side to the other."""
    if "delta" not in record:
        return []
    holds = _rudder_holds(record)
    time, stretches, chain = elapsed(record), list[LogStretch](), list[tuple[int, int, float]]()
    for hold in [*holds, (len(record), len(record), np.inf)]:
        if chain and not _goes_on(chain, hold):
            angles = [angle for _, _, angle in chain]
            if len(chain) >= _SPIRAL_HOLDS and min(angles) < 0.0 < max(angles):
                text = f"rudder held at {len(chain)} angles from {angles[0]:.0f} to {angles[-1]:.0f} deg"
                stretches.append(LogStretch("spiral", float(time[chain[0][0]]), float(time[chain[-1][1] - 1]), text))
            chain = chain[-1:] if chain and abs(hold[2] - chain[-1][2]) <= _LARGEST_STEP_DEG else []
        chain.append(hold)
    return stretches


def _rudder_holds(record: Record) -> list[tuple[int, int, float]]:
    """First row, row after the last, and angle [deg] of the stretches in which the rudder stays within a degree."""
    stride = max(1, round(_LOOK_S / record.dt))
    degrees = np.degrees(padded(record, record["delta"]))[::stride].tolist()
    holds, first = list[tuple[int, int, float]](), 0
    for row in range(1, len(degrees) + 1):
        if row < len(degrees) and abs(degrees[row] - degrees[first]) <= _HOLD_DEG:
            continue
        if (row - first) * stride * record.dt >= _HOLD_S:
            holds.append((first * stride, min(row * stride, len(record)), float(np.median(degrees[first:row]))))
        first = row
    return holds


def _goes_on(chain: list[tuple[int, int, float]], hold: tuple[int, int, float]) -> bool:
    """Whether a hold continues a chain: one step further to the same side."""
    step = hold[2] - chain[-1][2]
    direction = np.sign(chain[-1][2] - chain[0][2])
    return 0.0 < abs(step) <= _LARGEST_STEP_DEG and (direction == 0.0 or np.sign(step) == direction)


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


def half_swing_angles(phi: Array) -> Array:
    """Return the largest angle of each swing to one side, rad; phi: about its rest."""
    return np.array([half_swing.angle for half_swing in half_swings(phi)])


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
