"""Readings that no ship can show, such as 1e150 m/s: refused before anything is computed from them."""

import numpy as np

from seatrial.core.values import InputError, Record

# in SI units: the pitching moment of the heaviest ship is 1e12 N m; ours, a thousand times that
_LARGEST_READING = 1e15


def require_possible_sizes(record: Record) -> None:
    """Refuse a record with a reading that no ship can show; empty readings pass.

    Raises:
        InputError: there is one; the first is named.
    """
    for symbol, channel in record.channels.items():
        rows = np.flatnonzero(np.abs(channel.values) > _LARGEST_READING)
        if rows.size:
            raise InputError(
                f"record '{record.name}': channel '{symbol}' is {channel.values[rows[0]]:.3g} {channel.unit} at "
                f"{record.time[rows[0]]:.6g} s, which no ship shows; correct its unit, or leave the cell empty"
            )
