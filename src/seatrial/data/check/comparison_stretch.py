"""The part of a long record on which channels are compared with one another."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import Record

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
