"""Phases of a run: getting under way, the approach, the release of a roll decay, coasting, and what is compared."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from types import MappingProxyType

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.core.values.arrays import unwrapped
from seatrial.core.values.notation import TWIN_DIFFERENCES
from seatrial.data.check.consequences import moment
from seatrial.data.check.motion import MIN_SAMPLES, sample_noise, smoothed, window_length
from seatrial.physics.manoeuvres import steered_orders
from seatrial.physics.manoeuvres.track import speed
from seatrial.physics.manoeuvres.turns import course_of

# The part of a long record on which channels are compared with one another.

MOST_ROWS = 30_000
"""Rows of a record that are compared; chosen: fifty minutes at 10 Hz, some dozen manoeuvres."""
_MOST_TURN = 0.05
"""Heading [rad] by which a craft may turn within a mean of rows; chosen: a velocity turned so far errs by 0.01 %."""


def comparison_stretch(record: Record) -> Record:
    """Return the rows of a complete, evenly sampled record in which channels are compared: all of them up to 30 000.

    Of a longer one rows are averaged in groups while the craft hardly turns within a group; if more remain, the stretch
    with most turning is taken, which shows frames, signs and units best. Angles are unwrapped.
    """
    if len(record) <= MOST_ROWS:
        return record
    turning = np.abs(np.diff(record["psi"], prepend=record["psi"][0])) if "psi" in record else np.ones(len(record))
    group = _group_length(turning, -(-len(record) // MOST_ROWS)) if "psi" in record else 1
    thinned = _mean_of_groups(record, group)
    if len(thinned) <= MOST_ROWS:
        return thinned
    turned = np.cumsum(turning[: len(thinned) * group].reshape(-1, group).sum(axis=1))
    first = int(np.argmax(turned[MOST_ROWS:] - turned[:-MOST_ROWS]))
    return thinned.rows(slice(first, first + MOST_ROWS))


def _group_length(turning: np.ndarray, longest: int) -> int:
    """Most rows that are averaged: the longest, or fewer where the craft turns too far within them."""
    quick = 0.999  # quantile of the turning of one row: single wild ones do not count; chosen
    fastest = float(np.quantile(turning, quick))
    return longest if fastest * longest <= _MOST_TURN else max(1, int(_MOST_TURN / fastest))


def _mean_of_groups(record: Record, group: int) -> Record:
    if group == 1:
        return record
    count = len(record) // group

    def mean(values: np.ndarray) -> np.ndarray:
        return values[: count * group].reshape(count, group).mean(axis=1)

    channels = {symbol: channel.with_values(mean(channel.values)) for symbol, channel in record.channels.items()}
    return replace(record, time=mean(record.time), channels=channels)


# The approach of a manoeuvre: whether a craft runs straight at a steady speed when the rudder is first put over.

EXECUTION_FRACTION = 0.2  # of the record's largest rudder angle, from which on the rudder is put over; chosen
# s before the execute over which the speed is looked at, and share of the run at least; chosen: some lengths of a model
_SPEED_S, _SPEED_SHARE = 10.0, 0.1
# yaw rate at the execute over the largest, change of speed before it over the mean, and standard errors of that change,
# up to which an approach is steady; chosen
_TURNS, _CHANGES, _STANDARD_ERRORS = 0.2, 0.03, 4.0
_FEWEST_ROWS = 5  # before the execute, for a change of speed; chosen


def first_execution(record: Record) -> int:
    """Return the row at which the rudder is first put over; 0 where it never is.

    Raises:
        InputError: the record has no channel delta.
    """
    rudder = np.abs(record["delta"])
    return int(np.argmax(rudder >= EXECUTION_FRACTION * np.max(rudder)))


def approach_fault(record: Record) -> str:
    """Return why the approach of a complete record is not steady; empty where it is, or where nothing shows it."""
    if "delta" not in record or len(record) < MIN_SAMPLES:
        return ""
    row = first_execution(record)
    return _still_turns(record, row) or _speed_changes(record, row)


def approach_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning where a zigzag or a turn of a clean, signed record begins while the craft is still settling."""
    fault = approach_fault(record)
    if not fault or steered_orders(record) is None:
        return ()
    text = f"record '{record.name}': no steady approach before the first execute"
    advice = (
        "start the run earlier, on a straight course at a steady speed; its approach speed counts only where no run "
        "has a steady one"
    )
    return (Finding(Severity.WARNING, "approach", text, fault, advice),)


def _still_turns(record: Record, row: int) -> str:
    """The yaw rate before the execute, at the craft's own time scale, where it is a fifth of the largest."""
    psi = _heading(record)
    if psi is None:
        return ""
    course = course_of(psi)
    before = psi[max(0, row - 2 * course.scale) : row + 1]
    if before.size <= course.scale:
        return ""
    place = np.linspace(-0.5, 0.5, before.size) * (before.size - 1)
    rate = abs(float(place @ before) / float(place @ place))
    if rate <= _TURNS * course.rate:
        return ""
    here, largest = np.degrees(rate) / record.dt, np.degrees(course.rate) / record.dt
    return f"it turns at {here:.2g} deg/s there, and by {largest:.2g} deg/s at most in the run"


def _heading(record: Record) -> Array | None:
    if "psi" in record:
        return unwrapped(record["psi"])
    return np.cumsum(record["r"]) * record.dt if "r" in record else None


def _speed_changes(record: Record, row: int) -> str:
    """The change of speed (of a straight line through it) in the time before the execute, where it is large."""
    flow = speed(record)
    first = max(0, row - round(max(_SPEED_S, _SPEED_SHARE * record.duration) / record.dt))
    if flow is None or row - first < _FEWEST_ROWS:
        return ""
    values = flow[first:row]
    place = np.linspace(-0.5, 0.5, values.size)
    change = float(place @ values) / float(place @ place)
    scatter = float(np.std(values - values.mean() - change * place))
    error = scatter / float(np.sqrt(place @ place))
    mean = float(values.mean())
    if abs(change) <= max(_CHANGES * abs(mean), _STANDARD_ERRORS * error):
        return ""
    start, end = mean - 0.5 * change, mean + 0.5 * change
    return f"speed {start:.3g} to {end:.3g} m/s in the {(row - first) * record.dt:.2g} s before it"


# The release of a decay: what lies before it was held or driven by hand, and is no motion of the ship alone.

SWINGING: Mapping[str, str] = MappingProxyType({"phi": "roll", "theta": "pitch", "z": "heave"})
"""Channels of motions that have a rest to which they swing back, and their names."""

_HELD_NOISE = 3.0  # standard deviations of noise by which an angle that is held differs from the largest; chosen
# share of the largest angle that a swing loses in a fourteenth of its period, acos(0.9) / (2 pi), and shares of the
# time from there to amidships that are a hold; chosen
_NEAR, _HOLD_SHARE = 0.9, 1.5
_LEAVES = 0.97  # of the level of an angle that is held, down to which it still is; chosen: a free one falls so in T/25
_SHRINKS = 2.0  # largest swing over the largest of the last third of a decay; chosen
_NORMAL_MEDIAN = 0.6745  # standard deviations, median of the size of a normal error
_FEWEST_DECAY_ROWS = 30  # of a decay; chosen
_DRIVEN = ("delta", "alpha_w", "alpha_f", "u", "psi", "r")  # channels of records that are no free decays
_NOISE_SAMPLES = 2  # samples of a swing that is but noise about zero; chosen
_AS_LARGE = 0.95  # of the largest swing, from which on one is as large; chosen
_CALM = 0.15  # of the largest swing, below which a ship lies calm; chosen
_DRIVEN_SWINGS = 2  # half swings that grow towards the largest one, from which on it is driven; chosen: one is pulled
_STEADY = 0.5  # of the decrement of later swings, below which a ship that dies out is still driven; chosen
_GROWING_SWINGS = 3  # half swings in a row that grow or die out together; chosen
_GROUP = 0.3  # of the largest level, above which a group of swings counts; chosen
_WAVE_SHARE = 0.5  # groups that grow out of a motion over those that die out: a sea has as many; chosen


@dataclass(frozen=True)
class HalfSwing:
    """The motion between two times at rest: its first row, the row after its last, its largest value [rad or m]."""

    first: int
    stop: int
    angle: float


def half_swings(phi: Array) -> list[HalfSwing]:
    """Return the swings to one side each, without those that are but noise about zero; phi: about its rest, (n,)."""
    edges = np.flatnonzero(np.diff(phi >= 0.0)) + 1
    swings = (HalfSwing(int(a), int(b), float(np.max(np.abs(phi[a:b])))) for a, b in pairwise(edges))
    return [swing for swing in swings if swing.stop - swing.first > _NOISE_SAMPLES]


def half_swing_angles(phi: Array) -> Array:
    """Return the largest angle of each swing to one side, rad; phi: about its rest."""
    return np.array([half_swing.angle for half_swing in half_swings(phi)])


def driven_swings(chain: Sequence[HalfSwing]) -> int:
    """Return how many of the swings were driven, by people who run from side to side, before the last as large one.

    Those of a driven ship grow towards the largest, or stay as large although they die out afterwards; one that is
    pulled over and let go has no such swings.
    """
    angles = np.array([one.angle for one in chain])
    large = np.flatnonzero(angles >= _AS_LARGE * angles.max(initial=0.0))
    if not len(large):
        return 0
    first, last = int(large[0]), int(large[-1])
    calm = np.flatnonzero(angles[:first] <= _CALM * angles[first])
    growing = angles[int(calm[-1]) + 1 if len(calm) else 0 : first]
    is_steady = (
        last - first >= _DRIVEN_SWINGS
        and angles[last] > _SHRINKS * angles[-1]
        and _decrement(angles[first : last + 1]) < _STEADY * _decrement(angles[last::2]) / 2.0
    )
    return last if len(growing) >= _DRIVEN_SWINGS or is_steady else 0


def _decrement(angles: Array) -> float:
    """Return the decrease of the logarithm of the angle from swing to swing; 0 of a single one."""
    return float(np.log(angles[0] / angles[-1])) / max(len(angles) - 1, 1)


def is_in_waves(phi: Array) -> bool:
    """Return whether the roll, about its rest (n,), grows out of a motion about as often as it dies out.

    A ship that is let go lies calm before it is driven or pulled over; in a sea groups of swings follow one another.
    """
    angles = half_swing_angles(phi)
    level = 0.5 * (angles[1:] + angles[:-1])  # of both sides: a heel is no growth
    groups = list(_groups(level))
    dying = sum(1 for start, end in groups if start > end)
    growing = sum(1 for start, end in groups if end > start > _CALM * end)
    return growing > _WAVE_SHARE * dying


def _groups(level: Array) -> Iterator[tuple[float, float]]:
    """Yield first and last level of the swings that grow or die out together; what the record begins with is left out.

    Nobody knows what came before growth with which a record begins.
    """
    largest, place = level.max(initial=0.0), 0
    for is_growing, steps in groupby(np.diff(level) > 0.0):
        start, place = place, place + len(list(steps))
        is_begun = is_growing and start == 0
        if place - start >= _GROWING_SWINGS and max(level[start], level[place]) > _GROUP * largest and not is_begun:
            yield float(level[start]), float(level[place])


def release_row(swing: Array) -> int:
    """Return the row from which on a motion about its rest, (n,), is free: the last of the largest to within noise.

    Of one that is held for longer than it takes to fall, the row after the last one near the level at which it was
    held: the release lies between the two. It wanders by more than noise while it is pulled, and the largest comes long
    before the release.

    Of a ship that was driven from side to side, the peak of the last swing as large as the largest.

    swing: up to the first time that it crosses its rest, or beyond.
    """
    size = np.abs(swing)
    first = int(np.argmax(size))
    swings = half_swings(swing)
    if driven := driven_swings(swings):
        last = swings[driven]
        first = last.first + int(np.argmax(size[last.first : last.stop]))
    start, near, stop = _crest(swing, first)
    noise = _HELD_NOISE * (swing_noise(swing) if len(swing) > _FEWEST_DECAY_ROWS else 0.0)
    largest = first + int(np.flatnonzero(size[first:stop] >= size[first] - noise)[-1])
    if near - start <= _HOLD_SHARE * (stop - near):
        return largest
    level = float(np.median(size[start : near + 1]))
    leaves = first + int(np.flatnonzero(size[first:stop] >= _LEAVES * level)[-1])
    return min((largest if leaves - largest < stop - near else leaves) + 1, stop - 1)


def _crest(swing: Array, top: int) -> tuple[int, int, int]:
    """Return the first and the last row on this side about a top that are near it, and the first beyond the rest."""
    is_near = np.abs(swing) >= _NEAR * abs(swing[top])
    other = np.flatnonzero(np.sign(swing) != np.sign(swing[top]))
    side = np.searchsorted(other, top)
    begin, stop = (int(other[side - 1]) + 1 if side else 0), (int(other[side]) if side < len(other) else len(swing))
    rows = begin + np.flatnonzero(is_near[begin:stop])
    return int(rows[0]), int(rows[-1]), stop


def swing_noise(swing: Array) -> float:
    """Return the standard deviation of white noise on a motion that swings at one frequency, (n,).

    Coarse samples of it change by more than noise in third differences; two samples predict the next of such a motion
    (a damped oscillation is autoregressive of order two). The median of what is left is not moved by a release.
    """
    past = np.stack([swing[1:-1], swing[:-2]], axis=1)
    weights = np.linalg.lstsq(past, swing[2:], rcond=None)[0]
    left = float(np.median(np.abs(swing[2:] - past @ weights))) / _NORMAL_MEDIAN
    return min(sample_noise(swing), left / math.sqrt(1.0 + float(weights @ weights)))


def about_rest(values: Array) -> Array:
    """Return a motion about that in which it ends, (n,)."""
    return values - np.median(values[-max(1, len(values) // 4) :])


def swinging_channel(record: Record) -> str:
    """Return the first of roll, pitch and heave that dies out, or else the first that is recorded; empty: none is."""
    present = [channel for channel in SWINGING if channel in record]
    sizes = {channel: np.abs(about_rest(record[channel])) for channel in present}
    dying = (c for c, size in sizes.items() if np.max(size) >= _SHRINKS * np.max(size[-max(1, len(size) // 3) :]))
    return next(dying, present[0] if present else "")


def swing_text(channel: str, value: float) -> str:
    """Return the size of a swing in words: degrees, or metres of heave."""
    return f"{significant(value, 2)} m" if channel == "z" else f"{significant(float(np.degrees(value)), 2)} deg"


def is_free_decay(record: Record) -> bool:
    """Return whether a motion dies out from a release, with nothing recorded that drives it."""
    return _release(record) is not None


def begins_before_release(record: Record) -> bool:
    """Return whether a free decay begins long before its release: with a motion that is held, or on its way."""
    release = _release(record)
    return release is not None and release.row > _HOLD_SHARE * release.fall > 0.0


def release_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning where a free decay begins with a motion that is held, or that is driven."""
    release = _release(record)
    if release is None or not release.fall or not (release.is_driven or release.held > _HOLD_SHARE * release.fall):
        return ()
    size, seconds = (
        swing_text(release.channel, release.size),
        (release.row if release.is_driven else release.held) * record.dt,
    )
    what, evidence = (
        ("driven", f"it grows to {size} within {seconds:.1f} s, then dies out")
        if release.is_driven
        else ("held", f"within {100 * (1 - _NEAR):.0f} % of {size} for {seconds:.1f} s, then a decay")
    )
    return (
        Finding(
            Severity.WARNING, "held-roll",
            f"record '{record.name}': the {SWINGING[release.channel]} is {what} before it is released", evidence,
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class _Release:
    """Of a free decay: its channel, the row of its release and the size; rows it was held before, and to the rest.

    size: rad or m. is_driven: whether swings that grow lead to it.
    """

    channel: str
    row: int
    size: float
    held: int
    fall: int
    is_driven: bool


def rolls_out(record: Record) -> bool:
    """Return whether a ship rolls out from a release, under way or not, whatever else is recorded."""
    return "phi" in record and _swing_release(record) is not None


def _release(record: Record) -> _Release | None:
    """The release of a free decay; None of another record."""
    return None if any(name in record for name in _DRIVEN) else _swing_release(record)


def _swing_release(record: Record) -> _Release | None:
    channel = swinging_channel(record)
    if not channel or len(record) < _FEWEST_DECAY_ROWS:
        return None
    swing = about_rest(record[channel])
    size, row = np.abs(swing), release_row(swing)
    top = row - 1 if row and size[row - 1] > size[row] else row  # a hold ends before the row of its release
    if size[top] < _SHRINKS * np.max(size[-len(size) // 3 :]):
        return None
    start, near, stop = _crest(swing, top)
    is_driven = driven_swings(half_swings(swing)) > 0
    return _Release(
        channel, row, float(size[top]), max(top - start, 0), stop - near if stop < len(swing) else 0, is_driven
    )


# Phases of a run that are not the manoeuvre: getting under way and coasting.

# shares of largest revolutions (stopped) and of the speed reached (slow, under way); chosen
STOPPED_FRACTION, SLOW_FRACTION, RUNNING_FRACTION = 0.05, 0.5, 0.8
# quantile of the speed that counts as reached; chosen: a few wild samples do not count
REACHED_QUANTILE = 0.95
# s without propeller that count as coasting; chosen
MIN_COASTING_S = 2.0


def phase_findings(record: Record) -> tuple[Finding, ...]:
    """Return findings on acceleration and a stopped propeller at the ends of a clean, signed record."""
    return (*_acceleration_findings(record), *_propeller_findings(record))


def acceleration_end_time(record: Record) -> float | None:
    """Return when a run that starts below half its speed first reaches four fifths of it [s]; None if it starts faster.

    Its speed is the 95 % quantile of the smoothed speed.
    """
    U = speed(record)
    if U is None or len(record) < MIN_SAMPLES:
        return None
    length = window_length(len(record))
    U = smoothed(U, length)
    reached = float(np.quantile(U, REACHED_QUANTILE))
    if reached <= 0 or U[0] > SLOW_FRACTION * reached:
        return None
    return float(record.time[int(np.argmax(RUNNING_FRACTION * reached <= U)) + length // 2])


def _acceleration_findings(record: Record) -> list[Finding]:
    end = acceleration_end_time(record)
    if end is None:
        return []
    U = speed(record)
    assert U is not None
    text = f"record '{record.name}': the ship is still gathering speed until {moment(end)}"
    evidence = f"speed {U[0]:.3g} m/s at first, {np.quantile(U, REACHED_QUANTILE):.3g} m/s later"
    advice = "leave the phase out of manoeuvring measures, or fit it with a model that covers it"
    return [Finding(Severity.INFO, "acceleration-phase", text, evidence, advice)]


def _propeller_findings(record: Record) -> list[Finding]:
    if "n" not in record:
        return []
    n = np.abs(record["n"])
    if (apart := TWIN_DIFFERENCES["n"]) in record:
        n += np.abs(record[apart]) / 2  # of the faster of two shafts
    turning = np.flatnonzero(n > STOPPED_FRACTION * n.max())
    if n.max() == 0 or turning.size == 0:
        return []
    first, last = int(turning[0]), int(turning[-1])
    findings = []
    if first > 0:
        text = f"record '{record.name}': the propeller is stopped until {moment(record.time[first])}"
        advice = "cut the beginning, or use a model that covers rest"
        findings.append(Finding(Severity.INFO, "propeller-stopped", text, f"{first} samples", advice))
    rest = record.time[-1] - record.time[last]
    if rest >= MIN_COASTING_S:
        text = f"record '{record.name}': the ship coasts from {moment(record.time[last])} on, the propeller stopped"
        advice = "leave coasting out of turning measures; it carries information on resistance"
        findings.append(Finding(Severity.INFO, "coasting", text, f"{rest:.3g} s at the end", advice))
    return findings
