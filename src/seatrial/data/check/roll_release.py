"""The release of a roll decay: what lies before it was held by hand, and is no motion of the ship alone."""

from dataclasses import dataclass

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


def release_row(swing: Array) -> int:
    """Return the last row at which an angle, about its rest, is the largest to within noise, shape (n,).

    Of one that is held for longer than it takes to fall, the last row near the level at which it was held: it wanders
    by more than noise while it is pulled, and the largest comes long before the release.

    swing: up to the first time that it crosses its rest, or beyond.
    """
    size = np.abs(swing)
    first = int(np.argmax(size))
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
    """Return a warning where a free roll decay begins with an angle that is held."""
    release = _release(record)
    if release is None or not release.fall or release.held <= _HOLD_SHARE * release.fall:
        return ()
    angle, seconds = np.degrees(release.angle), release.held * record.dt
    return (
        Finding(
            Severity.WARNING, "held-roll", f"record '{record.name}': the roll angle is held before it is released",
            f"within {100 * (1 - _NEAR):.0f} % of {angle:.1f} deg for {seconds:.1f} s, then a decay",
            "from_release = true under [[records]] drops what lies before the release",
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class _Release:
    """Of a free decay: the row of its release and the angle [rad]; rows it was held before, and from it to the rest."""

    row: int
    angle: float
    held: int
    fall: int


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
    return _Release(row, float(size[row]), row - start, int(after[0]) if after.size else 0)
