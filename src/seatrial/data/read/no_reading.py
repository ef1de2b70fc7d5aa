"""Readings that stand for none: fixes at 0/0, and values such as -999; emptied before anything is joined or derived."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import Array
from seatrial.core.values.no_reading import EMPTIED, sentinel_value
from seatrial.data.read.derive import Measured


def without_fixes_at_zero(measured: dict[str, Measured], time: Array) -> tuple[dict[str, Measured], str]:
    """Return columns of one table (n,) without fixes at latitude 0, longitude 0, and a sentence; empty: none.

    time: stamps (n,) [s]. Receivers write 0/0 where they have no fix.
    """
    if not {"lat", "lon"} <= set(measured):
        return measured, ""
    rows = (measured["lat"].values == 0.0) & (measured["lon"].values == 0.0)
    if not rows.any():
        return measured, ""
    emptied = {s: replace(measured[s], values=np.where(rows, np.nan, measured[s].values)) for s in ("lat", "lon")}
    text = f"'lat', 'lon': {rows.sum()} of {rows.size} fixes lie at 0/0, {_times(time[rows])}, and {EMPTIED}"
    return measured | emptied, text


def without_sentinel(one: Measured, time: Array) -> tuple[Measured, str]:
    """Return a measured column (n,) without the value that stands for no reading, and a sentence; empty: none.

    time: stamps (n,) [s]. Commands are left alone.
    """
    sentinel = None if one.column.is_held else sentinel_value(one.values, one.column.quantity.unit)
    if sentinel is None:
        return one, ""
    rows = one.values == sentinel
    text = f"'{one.column.symbol}': {rows.sum()} of {rows.size} readings are {sentinel:.6g} {one.column.quantity.unit}"
    return replace(one, values=np.where(rows, np.nan, one.values)), f"{text}, {_times(time[rows])}, and {EMPTIED}"


def _times(stamps: Array) -> str:
    """The first and the last of the times, as findings state times of the logger's clock."""
    return f"the first and the last at t = {stamps[0]:.12g} to {stamps[-1]:.12g} s"
