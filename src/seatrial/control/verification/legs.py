"""Stretches of a log with the controller on and off, by whether the actuator moves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError, Record
from seatrial.physics.loops import TransferLoop

_WINDOW_PERIODS = 3.0  # natural periods over which an actuator that is on surely moves; chosen
_STILL_SHARE = 0.03  # of the liveliest window's rms, below which the actuator counts as still; chosen
_STILL_ANGLE = 1e-4  # rad, rms below which an actuator never moved: a resolver's last digit; chosen
_RUN_IN_PERIODS = 2.0  # natural periods after a change of control that belong to neither state; chosen
_SHORTEST_PERIODS = 36.0  # natural periods that a leg must hold: five segments of its spectrum; chosen
_WAVES = "zeta"
_RATE = 24.0  # samples a natural period that the spectra need; chosen


@dataclass(frozen=True, eq=False)
class LoggedLeg:
    """A stretch of one record, every dt [s] from `start` [s]; U: m/s, mean speed.

    values: (n, 2) or (n, 3): output, actuator, and the elevation of the waves where all records hold it; SI.
    """

    record: str
    start: float
    dt: float
    values: Array
    is_controlled: bool
    U: float

    @property
    def stop(self) -> float:
        """Return the time of the last sample [s]."""
        return self.start + self.dt * (len(self.values) - 1)


def natural_period(loop: TransferLoop) -> float:
    """Return the period [s] of the plant's least damped swing.

    Raises:
        InputError: it does not swing.
    """
    poles = loop.plant.poles[loop.plant.poles.imag > 0.0]
    if not poles.size:
        raise InputError(f"the plant of loop '{loop.name}' does not swing; legs in waves need a motion that does")
    return float(2.0 * np.pi / np.abs(poles[np.argmin(-poles.real / np.abs(poles))]))


def legs_on_and_off(records: Sequence[Record], loop: TransferLoop, U: float) -> tuple[LoggedLeg, ...]:
    """Return the legs of all records that are long enough for a spectrum, in order.

    U: m/s, where a record has no channel 'u'.

    Raises:
        InputError: a channel is missing, no leg is long enough, or none has the controller on.
    """
    period = natural_period(loop)
    for record in records:
        if missing := [name for name in (loop.output, loop.actuator) if name not in record]:
            raise InputError(
                f"record '{record.name}' has no channel '{missing[0]}'; a loop from '{loop.actuator}' on "
                f"'{loop.output}' is verified by both: name their columns in [records.channels]"
            )
    waves = (_WAVES,) if all(_WAVES in record for record in records) else ()
    channels = (loop.output, loop.actuator, *waves)
    records = [record.resampled(_RATE / period) for record in records]
    activities = [_activity(record[loop.actuator], round(_WINDOW_PERIODS * period / record.dt)) for record in records]
    liveliest = max((float(np.nanmax(activity, initial=0.0)) for activity in activities), default=0.0)
    if liveliest < _STILL_ANGLE:
        raise InputError(f"'{loop.actuator}' never moves in the log: there is no leg with the controller on")
    legs = [
        leg
        for record, activity in zip(records, activities, strict=True)
        for leg in _legs_of_record(record, channels, activity >= _STILL_SHARE * liveliest, period, U)
    ]
    needed = _SHORTEST_PERIODS * period
    long_enough = tuple(leg for leg in legs if leg.stop - leg.start >= needed)
    if not any(leg.is_controlled for leg in long_enough):
        longest = max((leg.stop - leg.start for leg in legs if leg.is_controlled), default=0.0)
        raise InputError(
            f"the longest leg with the controller on takes {longest:.0f} s; {needed:.0f} s are needed, "
            f"{_SHORTEST_PERIODS:g} natural periods, for a spectrum; log longer legs"
        )
    return long_enough


def _activity(values: Array, window: int) -> Array:
    """Return the rms of the actuator about its mean in a window about each sample, (n,); NaN across gaps."""
    half = max(1, window // 2)
    padded = np.pad(values, half, mode="edge")
    sums, squares = (np.concatenate([[0.0], np.cumsum(np.nan_to_num(v))]) for v in (padded, padded**2))
    width = 2 * half
    mean, square = ((s[width:] - s[:-width])[: len(values)] / width for s in (sums, squares))
    return np.where(np.isfinite(values), np.sqrt(np.maximum(square - mean**2, 0.0)), np.nan)


def _legs_of_record(
    record: Record, channels: tuple[str, ...], is_moving: NDArray[np.bool_], period: float, U: float
) -> list[LoggedLeg]:
    """Return the stretches of one state without gaps, less the run-in and the window's half at inner ends."""
    values = record.matrix(channels)
    state = np.where(np.all(np.isfinite(values), axis=1), is_moving.astype(int), -1)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(state)) + 1, [len(state)]])
    lead, tail = (round(share * period / record.dt) for share in (_RUN_IN_PERIODS, 0.5 * _WINDOW_PERIODS))
    legs = []
    for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        begin, end = first + (lead if first else 0), last - (tail if last < len(state) else 0)
        if state[first] < 0 or end - begin < 2:
            continue
        speed = float(np.nanmean(record["u"][begin:end])) if "u" in record else U
        legs.append(LoggedLeg(
            record.name, float(record.time[begin]), record.dt, values[begin:end], bool(state[first]), speed,
        ))  # fmt: skip
    return legs
