"""Samples left out of a record before a regression: outliers, repetitions, holes, small values.

The four steps of Song et al. 2025 (doi 10.19693/j.issn.1673-3185.03832), eqs. (5)-(8), each from record to record.
What stays keeps its time and its order, so that the time base may be uneven afterwards; nothing is filled in. The
record keeps its kind, and its provenance says how many samples went. A sample is one row of all channels, also of those
a step does not look at.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError, Record

Mask = NDArray[np.bool_]
# a channel whose range is a smaller part of its size is constant
ROUNDING = 1e-12


def without_outliers(record: Record, limit: float, channels: Sequence[str]) -> Record:
    """Samples whose standard score is at most `limit` in each of the channels.

    One pass, as published: mean and deviation are those of the whole record, outliers among them, so that a second
    pass may find more. In n samples no score exceeds sqrt(n - 1). Missing values count neither for nor against a
    sample; infinite ones are outliers.

    Args:
        record: angles are taken as they stand; a heading that jumps by 360 deg should be unwrapped first.
        limit: largest absolute score that stays, above 0, e.g. 3.
        channels: which are looked at.

    Raises:
        InputError: a channel is unknown, constant or without values; the limit is not positive; nothing would stay.
    """
    _demand_channels(record, channels, "without_outliers")
    if not 0.0 < limit < np.inf:
        raise InputError(f"record '{record.name}': the limit of standard scores is {limit:g}; give one above 0, e.g. 3")
    out = np.any([np.abs(_scores(record, symbol)) > limit for symbol in channels], axis=0)
    return _keep_samples(record, ~out, f"outliers, standard score above {limit:g} in {', '.join(channels)}")


def without_duplicates(record: Record, channels: Sequence[str]) -> Record:
    """The first of all samples that are equal in every one of the channels, whether they follow one another or not.

    Song et al. 2025, eq. (6). Equal means the same number; time is not compared. A missing value equals nothing, not
    even another one.

    Raises:
        InputError: a channel is unknown, or none is named.
    """
    _demand_channels(record, channels, "without_duplicates")
    return _keep_samples(
        record, first_occurrences(record.matrix(tuple(channels))), f"repetitions in {', '.join(channels)}"
    )


def without_missing(record: Record, channels: Sequence[str]) -> Record:
    """Samples with a finite number in each of the channels and a time of their own.

    Song et al. 2025, eq. (7): the whole sample goes, also its good values.

    Raises:
        InputError: a channel is unknown, none is named, or nothing would stay.
    """
    _demand_channels(record, channels, "without_missing")
    whole = np.isfinite(record.matrix(tuple(channels))).all(axis=1) & np.isfinite(record.time)
    return _keep_samples(record, whole, f"missing values in {', '.join(channels)}")


def without_small(record: Record, thresholds: Mapping[str, float]) -> Record:
    """Samples whose absolute value is at or above the threshold in each of the channels.

    Song et al. 2025, eq. (8). Missing values stay.

    Args:
        record: its values in SI units.
        thresholds: smallest absolute value that stays by channel, in the channel's SI unit (angles in rad), from 0.

    Raises:
        InputError: a channel is unknown, none is named, a threshold is negative or no number, or nothing would stay.
    """
    _demand_channels(record, tuple(thresholds), "without_small")
    for symbol, threshold in thresholds.items():
        if not 0.0 <= threshold < np.inf:
            raise InputError(
                f"record '{record.name}': the threshold of channel '{symbol}' is {threshold:g}; give a size in "
                f"{record.channel(symbol).unit}, 0 or more"
            )
    # Song et al. 2025, eq. (8): |z_i| >= Lambda stays
    small = np.any([np.abs(record[symbol]) < threshold for symbol, threshold in thresholds.items()], axis=0)
    limits = ", ".join(f"|{symbol}| < {size:g} {record.channel(symbol).unit}" for symbol, size in thresholds.items())
    return _keep_samples(record, ~small, f"small values, {limits}")


def standard_scores(values: Array) -> Array:
    """(x - mean) / standard deviation of the finite values, shape (n,); NaN stays NaN, infinities stay infinite.

    The standard deviation is that of the values as a population, so that the scores have the root mean square 1.
    Constant values give NaN or infinities: look before.
    """
    known = values[np.isfinite(values)]
    # Song et al. 2025, eq. (5): I = (X - E(X)) / sigma(X)
    return (values - np.mean(known)) / np.std(known)


def first_occurrences(rows: Array) -> Mask:
    """Whether each row is the first of its equals, shape (n,) of rows (n, k); NaN equals nothing."""
    order = np.lexsort(rows.T)  # stable: equal rows stay in their order
    ranked = rows[order]
    first = np.ones(len(rows), dtype=np.bool_)
    first[order[1:]] = np.any(ranked[1:] != ranked[:-1], axis=1)
    return first


def _scores(record: Record, symbol: str) -> Array:
    values = record[symbol]
    known = values[np.isfinite(values)]
    if not len(known):
        raise InputError(f"record '{record.name}': channel '{symbol}' holds no value; leave it out of without_outliers")
    if np.ptp(known) <= ROUNDING * np.max(np.abs(known)) or np.std(known) == 0.0:
        raise InputError(
            f"record '{record.name}': channel '{symbol}' is constant at {known[0]:g} {record.channel(symbol).unit} and "
            "has no standard score; leave it out of without_outliers"
        )
    return standard_scores(values)


def _demand_channels(record: Record, channels: Sequence[str], step: str) -> None:
    if not channels:
        raise InputError(f"record '{record.name}': {step} was given no channel to look at; name one at least")
    for symbol in channels:
        record.channel(symbol)


def _keep_samples(record: Record, mask: Mask, description: str) -> Record:
    """Return the samples that stay, with the step in the provenance."""
    gone = int(np.count_nonzero(~mask))
    if gone == len(record):
        raise InputError(
            f"record '{record.name}': all {gone} samples would go ({description}); change limits or channels"
        )
    kept = {symbol: channel.with_values(channel.values[mask]) for symbol, channel in record.channels.items()}
    step = f"{gone} of {len(record)} samples left out: {description}"
    return replace(record, time=record.time[mask], channels=kept, provenance=record.provenance.with_step(step))
