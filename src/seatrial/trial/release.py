"""A roll decay from its release on: what lies before the largest angle was held by hand."""

import numpy as np

from seatrial.values import Array, InputError, Record

_ABOVE_NOISE, _DECAYED = 5.0, 0.9
_LEAST_ROWS = 20


def released(record: Record) -> Record:
    """The record from its largest roll angle (about the angle it ends at) on.

    Raises:
        InputError: no roll angle, a start that is not above the noise, a motion that does not decay, too little of it.
    """
    if "phi" not in record:
        raise InputError(f"record '{record.name}': from_release needs the roll angle 'phi'; add the channel")
    swing = record["phi"] - np.median(record["phi"][-max(1, len(record) // 4) :])
    first = int(np.argmax(np.abs(swing)))
    largest, noise = abs(float(swing[first])), _noise(swing)
    if not largest > _ABOVE_NOISE * noise:
        raise InputError(
            f"record '{record.name}': the decay starts at {np.degrees(largest):.2g} deg, within the noise of "
            f"{np.degrees(noise):.2g} deg; release from a larger angle"
        )
    if len(record) - first < _LEAST_ROWS:
        raise InputError(
            f"record '{record.name}': the largest roll angle stands at {record.time[first]:g} s, so that nothing is "
            "left of the decay; give a longer record, or trim it by from_s"
        )
    after = np.abs(swing[first:])
    third = len(after) // 3
    if not after[-third:].max() < _DECAYED * after[:third].max():
        raise InputError(
            f"record '{record.name}': the roll does not decay: {np.degrees(after[:third].max()):.2g} deg in its first "
            f"third, {np.degrees(after[-third:].max()):.2g} deg in its last; leave the run out"
        )
    step = f"from its release on: the largest roll angle at {record.time[first]:g} s"
    kept = record.rows(slice(first, None))
    return kept.with_channel("phi", kept.channel("phi"), step)


def _noise(values: Array) -> float:
    """Standard deviation of white noise by third differences, whose variance is 20 times that of the noise."""
    return float(np.std(np.diff(values, 3)) / np.sqrt(20.0))
