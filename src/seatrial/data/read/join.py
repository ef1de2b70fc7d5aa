"""Columns with time stamps of their own on one time base: commands held, angles unwrapped, the rest linear."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.core.values.record import MAX_SAMPLES
from seatrial.data.read.layout import ColumnSpec

# steps of a topic over which nothing is interpolated unless a time is stated, ours
_GAP_STEPS = 5.0
# steps of a topic within which a stamp of it counts as equal to one of the base, ours
_ROUNDING_STEPS = 1e-3


@dataclass(frozen=True, eq=False)
class Series:
    """One column in SI units with the stamps of its topic; time [s] and values have shape (n,), in order of time."""

    column: ColumnSpec
    time: Array
    values: Array
    label: str
    topic: str = ""

    @property
    def step(self) -> float:
        """Median time between two samples [s]."""
        steps = np.diff(self.time)
        return float(np.median(steps[steps > 0])) if np.any(steps > 0) else float("inf")


def ordered_series(column: ColumnSpec, time: Array, values: Array, label: str, topic: str = "") -> Series:
    """Return the series of stamped, finite samples in order of time; of equal stamps the last sample counts."""
    known = np.isfinite(time) & np.isfinite(values)
    order = np.argsort(time[known], kind="stable")
    stamps, numbers = time[known][order], values[known][order]
    keep = np.append(np.diff(stamps) > 0, True) if stamps.size else np.zeros(0, dtype=bool)
    return Series(column, stamps[keep], numbers[keep], label, topic)


def common_time(series: Sequence[Series], rate: float | None) -> Array:
    """Return the even time base [s] of several series: from the latest start to the earliest end.

    A held series counts from its first sample on and has no end. rate: Hz; None: of the slowest measured series.

    Raises:
        InputError: a series has fewer than two samples, they do not overlap, or there would be too many samples.
    """
    measured = [one for one in series if not one.column.is_held] or list(series)
    for one in series:
        if one.time.size < (1 if one.column.is_held else 2):
            raise InputError(
                f"channel '{one.column.symbol}' ({one.label}): {one.time.size} samples, which is too few; leave it out"
            )
    slowest = max(measured, key=lambda one: one.step)
    step = 1.0 / rate if rate is not None else slowest.step
    start = max(one.time[0] for one in series)
    if rate is None and start <= slowest.time[-1]:
        start = slowest.time[np.searchsorted(slowest.time, start)]
    stop = min(one.time[-1] for one in measured)
    if not stop - start >= step:
        first, last = max(series, key=lambda one: one.time[0]), min(measured, key=lambda one: one.time[-1])
        raise InputError(
            f"channels '{first.column.symbol}' and '{last.column.symbol}' do not overlap in time: "
            f"{first.label} starts {first.time[0] - last.time[-1]:.6g} s after {last.label} ends; "
            "check their clocks, or set clock_offset"
        )
    if not (stop - start) / step < MAX_SAMPLES:
        raise InputError(
            f"{slowest.label}: {stop - start:.6g} s at {1.0 / step:.6g} Hz are over {MAX_SAMPLES:.0e} samples; set a "
            "lower rate, and check the unit of the time"
        )
    return start + step * np.arange(int((stop - start) / step + _ROUNDING_STEPS) + 1)


def values_at(one: Series, time: Array, longest_gap: float | None) -> Array:
    """Return the series at the times [s], shape (n,); NaN between samples further apart than `longest_gap` [s]."""
    margin = _ROUNDING_STEPS * min(one.step, 1.0)
    before = np.searchsorted(one.time, time + margin, side="right") - 1
    if one.column.is_held:
        return np.where(before >= 0, one.values[np.maximum(before, 0)], np.nan)
    first, last = one.time[0], one.time[-1]
    near_end = ((time < first) & (time > first - margin)) | ((time > last) & (time < last + margin))
    time = np.where(near_end, np.clip(time, first, last), time)
    after = np.searchsorted(one.time, time - margin, side="left")
    is_angle = one.column.quantity.unit == "rad"
    smooth = np.unwrap(one.values) if is_angle else one.values
    values = np.interp(time, one.time, smooth, left=np.nan, right=np.nan)
    limit = _GAP_STEPS * one.step if longest_gap is None else longest_gap
    rows = len(one.time) - 1
    distance = one.time[np.clip(after, 0, rows)] - one.time[np.clip(before, 0, rows)]
    values[distance > limit] = np.nan
    return values
