"""A roll decay from its release on: what lies before it was held by hand."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.roll_release import begins_before_release, is_in_waves, release_row
from seatrial.data.check.signal import sample_noise

# first angle over noise; largest angle of the last third over that of the first, ours
_MIN_SIGNAL_TO_NOISE, _MAX_AMPLITUDE_RATIO = 5.0, 0.9
# share of the largest angle that counts as a swing, and how many before it need as many after it, ours
_EARLY_SWING_FRACTION, _MAX_EARLY_SWINGS = 0.2, 4
# fewest samples of a decay, ours
_MIN_ROWS = 20
# roll angle [rad] beyond which degrees were given without their unit
_MAX_ROLL_ANGLE = np.pi / 2.0


def trim_to_decay_start(record: Record) -> Record:
    """The record from its release on: the last time that its roll angle, about that it ends at, is the largest.

    People who run from side to side may have driven it before.

    Raises:
        InputError: no roll angle, a start that is not above the noise or beyond 90 deg of heel, a motion that does
            not decay, too little of it.
    """
    if "phi" not in record:
        raise InputError(f"record '{record.name}': from_release needs the roll angle 'phi'; add the channel")
    if len(record) < _MIN_ROWS:
        raise InputError(f"record '{record.name}': {len(record)} rows are no decay; give a longer record")
    swing = record["phi"] - np.median(record["phi"][-max(1, len(record) // 4) :])
    first = release_row(swing)
    largest, noise = abs(float(swing[first])), sample_noise(swing)
    if not largest > _MIN_SIGNAL_TO_NOISE * noise:
        raise InputError(
            f"record '{record.name}': the decay starts at {np.degrees(largest):.2g} deg, within the noise of "
            f"{np.degrees(noise):.2g} deg; release from a larger angle"
        )
    if largest > _MAX_ROLL_ANGLE:
        raise InputError(
            f"record '{record.name}': the decay starts at {np.degrees(largest):.4g} deg, beyond 90 deg of heel; "
            "check the unit of channel 'phi'"
        )
    early, late = (_swing_count(part, _EARLY_SWING_FRACTION * largest) for part in (swing[:first], swing[first:]))
    if early > _MAX_EARLY_SWINGS and (late < _MAX_EARLY_SWINGS or is_in_waves(swing)):
        raise InputError(
            f"record '{record.name}': the roll grows, to {np.degrees(largest):.2g} deg at {record.time[first]:g} s, "
            "instead of decaying from a release; leave the run out"
        )
    if len(record) - first < _MIN_ROWS:
        raise InputError(
            f"record '{record.name}': the largest roll angle stands at {record.time[first]:g} s, so that nothing is "
            "left of the decay; give a longer record, or trim it by from_s"
        )
    _require_smaller_last_third(record.name, swing[first:])
    step = f"from its release on: the largest roll angle at {record.time[first]:g} s"
    kept = record.rows(slice(first, None))
    return kept.with_channel("phi", kept.channel("phi"), step)


def need_release(records: Sequence[Record]) -> bool:
    """Return whether records are to be cut at their releases: one begins long before its own, and all have one."""
    try:
        for record in records:
            trim_to_decay_start(record)
    except InputError:
        return False
    return any(map(begins_before_release, records))


def require_decay(record: Record) -> None:
    """Refuse a record whose roll angle is as large at its end as at its beginning.

    Raises:
        InputError: both angles.
    """
    _require_smaller_last_third(record.name, record["phi"] - np.nanmedian(record["phi"]))


def _require_smaller_last_third(name: str, swing: Array) -> None:
    size = np.abs(swing)
    third = len(size) // 3
    first, last = float(np.nanmax(size[:third])), float(np.nanmax(size[-third:]))
    if not last < _MAX_AMPLITUDE_RATIO * first:
        raise InputError(
            f"record '{name}': the roll does not decay: {np.degrees(first):.2g} deg in its first third, "
            f"{np.degrees(last):.2g} deg in its last; leave the run out, or record what drives the ship"
        )


def _swing_count(values: Array, size: float) -> int:
    """How often the motion changes between one side and the other, both beyond `size`."""
    sides = np.sign(values[np.abs(values) > size])
    return int(np.sum(sides[1:] != sides[:-1]))
