"""The release of a roll decay: what lies before it was held or driven by hand, and is no motion of the ship alone."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.data.check.signal import sample_noise

_HELD_NOISE = 3.0  # standard deviations of noise by which an angle that is held differs from the largest; chosen
# share of the largest angle that a swing loses in a fourteenth of its period, acos(0.9) / (2 pi), and shares of the
# time from there to amidships that are a hold; chosen
_NEAR, _HOLD_SHARE = 0.9, 1.5
_LEAVES = 0.97  # of the level of an angle that is held, down to which it still is; chosen: a free one falls so in T/25
_SHRINKS = 2.0  # largest swing over the largest of the last third of a decay; chosen
_FEWEST_ROWS = 30  # of a decay; chosen
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
    """The roll between two times at rest: its first row, the row after its last, and its largest angle [rad]."""

    first: int
    stop: int
    angle: float


def half_swings(phi: Array) -> list[HalfSwing]:
    """Return the swings to one side each, without those that are but noise about zero; phi: about its rest, (n,)."""
    edges = np.flatnonzero(np.diff(phi >= 0.0)) + 1
    swings = (HalfSwing(int(a), int(b), float(np.max(np.abs(phi[a:b])))) for a, b in pairwise(edges))
    return [swing for swing in swings if swing.stop - swing.first > _NOISE_SAMPLES]


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
    angles = np.array([half_swing.angle for half_swing in half_swings(phi)])
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
    """Return the last row at which an angle, about its rest, is the largest to within noise, shape (n,).

    Of one that is held for longer than it takes to fall, the last row near the level at which it was held: it wanders
    by more than noise while it is pulled, and the largest comes long before the release.

    Of a ship that was driven from side to side, the peak of the last swing as large as the largest.

    swing: up to the first time that it crosses its rest, or beyond.
    """
    size = np.abs(swing)
    first = int(np.argmax(size))
    swings = half_swings(swing)
    if driven := driven_swings(swings):
        last = swings[driven]
        first = last.first + int(np.argmax(size[last.first : last.stop]))
    crossing = np.flatnonzero(np.sign(swing[first:]) != np.sign(swing[first]))
    stop = first + int(crossing[0]) if crossing.size else len(swing)
    noise = _HELD_NOISE * (sample_noise(swing) if len(swing) > _FEWEST_ROWS else 0.0)
    largest = first + int(np.flatnonzero(size[first:stop] >= size[first] - noise)[-1])
    near = first + np.flatnonzero(size[first:stop] >= _NEAR * size[first])
    fall = stop - int(near[-1])
    if len(near) <= _HOLD_SHARE * fall:
        return largest
    level = float(np.median(size[near]))
    leaves = first + int(np.flatnonzero(size[first:stop] >= _LEAVES * level)[-1])
    return largest if leaves - largest < fall else leaves


def is_free_decay(record: Record) -> bool:
    """Return whether the roll dies out from a release, with nothing recorded that drives it."""
    return _release(record) is not None


def begins_before_release(record: Record) -> bool:
    """Return whether a free roll decay begins long before its release: with an angle that is held, or on its way."""
    release = _release(record)
    return release is not None and release.row > _HOLD_SHARE * release.fall > 0.0


def release_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning where a free roll decay begins with an angle that is held, or with a roll that is driven."""
    release = _release(record)
    if release is None or not release.fall or not (release.is_driven or release.held > _HOLD_SHARE * release.fall):
        return ()
    angle, seconds = np.degrees(release.angle), (release.row if release.is_driven else release.held) * record.dt
    what, evidence = (
        ("driven", f"it grows to {angle:.1f} deg within {seconds:.1f} s, then dies out")
        if release.is_driven
        else ("held", f"within {100 * (1 - _NEAR):.0f} % of {angle:.1f} deg for {seconds:.1f} s, then a decay")
    )
    return (
        Finding(
            Severity.WARNING, "held-roll", f"record '{record.name}': the roll angle is {what} before it is released",
            evidence,
            "from_release = true under [[records]] drops what lies before the release",
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class _Release:
    """Of a free decay: the row of its release and the angle [rad]; rows it was held before, and from it to the rest.

    is_driven: whether swings that grow lead to it.
    """

    row: int
    angle: float
    held: int
    fall: int
    is_driven: bool


def _release(record: Record) -> _Release | None:
    """The release of a free roll decay; None of another record."""
    if "phi" not in record or any(name in record for name in _DRIVEN) or len(record) < _FEWEST_ROWS:
        return None
    swing = record["phi"] - np.median(record["phi"][-max(1, len(record) // 4) :])
    size, row = np.abs(swing), release_row(swing)
    if size[row] < _SHRINKS * np.max(size[-len(size) // 3 :]):
        return None
    start = int(np.flatnonzero(size >= _NEAR * size[row])[0])
    after = np.flatnonzero(np.sign(swing[row:]) != np.sign(swing[row]))
    is_driven = driven_swings(half_swings(swing)) > 0
    return _Release(row, float(size[row]), row - start, int(after[0]) if after.size else 0, is_driven)
