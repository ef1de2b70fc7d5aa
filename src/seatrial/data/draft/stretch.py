"""A stretch of a log that is a manoeuvre, and the signals in which manoeuvres are sought."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.signal import smoothed
from seatrial.physics.manoeuvres.track import speed

MIN_SAMPLES = 30
"""Samples below which nothing is a manoeuvre; as in the checks."""
_SMOOTHING_S = 2.0  # s over which rates and speeds are smoothed; chosen


@dataclass(frozen=True)
class LogStretch:
    """A manoeuvre in a log.

    Attributes:
        name: its kind, with the side.
        start, stop: s after the first sample.
        evidence: what shows it.
        released: s after the first sample from which on the rudder is amidships to the stop; None: it is not.
        is_left_out: whether it is offered as a run, and not used unless a person says so.
    """

    name: str
    start: float
    stop: float
    evidence: str
    released: float | None = None
    is_left_out: bool = False

    @property
    def kind(self) -> str:
        """What it is, without side and number."""
        return self.name.partition("_")[0].rstrip("0123456789")


def used_parts(offered: Sequence[LogStretch]) -> tuple[LogStretch, ...]:
    """Return those of the offered stretches of a run that are runs of their own."""
    return tuple(one for one in offered if not one.is_left_out)


def padded(record: Record, values: Array) -> Array:
    """Return values smoothed over two seconds, of the same length: the ends are held."""
    length = min(max(3, round(_SMOOTHING_S / record.dt)) | 1, (len(values) // 4) | 1)
    return np.pad(smoothed(values, length), length // 2, mode="edge")[: len(values)]


def elapsed(record: Record) -> Array:
    """Return the s since the first sample, shape (n,)."""
    return record.time - record.time[0]


def smooth_speed(record: Record) -> Array | None:
    """Return the smoothed speed [m/s], shape (n,); None where it is not recorded."""
    known = speed(record)
    if known is None and {"x0", "y0"} <= set(record.channels):
        known = np.hypot(*(np.gradient(padded(record, record[one]), record.dt) for one in ("x0", "y0")))
    return None if known is None else padded(record, known)
