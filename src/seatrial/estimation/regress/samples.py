"""Samples of a regression: left out of a record, or in pieces, to fit on some and judge on others."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, Index, InputError, Record
from seatrial.core.values.arrays import Mask
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, ObservedManoeuvre
from seatrial.physics.manoeuvres.turns import reversals

# Samples left out of a record before a regression: outliers, repetitions, holes, small values.

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


# A record in pieces, to fit on some and judge on others: contiguous blocks and folds, and what shuffling gives away.

# a reversal of heading counts from 2 deg or a tenth of the record's range of headings on, so that noise is none
MIN_REVERSAL, REVERSAL_SHARE = float(np.radians(2.0)), 0.1
FULL_CIRCLE = 2.0 * float(np.pi)


def blocks(record: Record, share: float) -> tuple[Record, Record]:
    """The first `share` of a record's samples for training, the rest for testing.

    Args:
        record: of any time base. Without channels ``delta`` and ``psi`` no manoeuvre is seen and none demanded.
        share: r of Song et al. 2025, eq. (9), between 0 and 1; 0.8 there.

    Raises:
        InputError: the share is outside (0, 1), a block would be empty or shorter than the longest manoeuvre, or
            stamps are missing.
    """
    count = len(record)
    first = training_rows(count, share)
    pieces = [record.rows(slice(0, first)), record.rows(slice(first, count))]
    longest = manoeuvre_seconds(record)
    shortest = min(pieces, key=_seconds)
    if shortest.duration < longest:
        piece = "the training block" if shortest is pieces[0] else "the test block"
        raise InputError(f"{_too_short(record, piece, shortest, longest)}; {_advise_share(record, longest)}")
    train, test = (
        _with_step(piece, f"{role} block: samples {begin + 1} to {begin + len(piece)} of {count}")
        for piece, role, begin in zip(pieces, ("training", "test"), (0, first), strict=True)
    )
    return train, test


def record_folds(record: Record, count: int) -> tuple[Index, ...]:
    """`folds` of a record's samples, each as long as the record's longest manoeuvre at least.

    Raises:
        InputError: as `folds`; a fold is shorter than the longest manoeuvre; stamps are missing.
    """
    made = folds(len(record), count)
    longest = manoeuvre_seconds(record)
    shortest = _shortest(record, made)
    if shortest.duration < longest:
        piece = f"the shortest of {count} folds"
        raise InputError(f"{_too_short(record, piece, shortest, longest)}; {_advise_folds(record, longest, count)}")
    return made


def folds(rows: int, count: int) -> tuple[Index, ...]:
    """Row numbers of `count` contiguous folds of nearly equal length, in order; together every row once.

    Raises:
        InputError: fewer than two folds, or more folds than rows.
    """
    if not 2 <= count <= rows:
        raise InputError(f"{rows} rows cannot be cut into {count} folds; give between 2 and {rows}")
    return tuple(np.array_split(np.arange(rows, dtype=np.int64), count))


def shuffled_split(rows: int, share: float, rng: np.random.Generator) -> tuple[Index, Index]:
    """Rows drawn at random for training, and the rest for testing, each in ascending order: to show how it leaks.

    Nearly every row for testing has a row for training next to it, from which it can be had without any model. Use
    `blocks` or `folds` to judge one.

    Raises:
        InputError: as `training_rows`.
    """
    first = training_rows(rows, share)
    drawn = rng.permutation(rows).astype(np.int64)
    return np.sort(drawn[:first]), np.sort(drawn[first:])


def training_rows(rows: int, share: float) -> int:
    """M = r N, rounded: how many of N rows are for training.

    Raises:
        InputError: the share is outside (0, 1), or leaves training or test without a row.
    """
    if not 0.0 < share < 1.0:
        raise InputError(f"the share for training is {share:g}; give one between 0 and 1, e.g. 0.8")
    first = round(share * rows)  # Song et al. 2025, eq. (9): M = r x N
    if not 0 < first < rows:
        raise InputError(f"a share of {share:g} for training puts {first} of {rows} rows there; give more rows")
    return first


def manoeuvre_seconds(record: Record) -> float:
    """Length [s] of the longest manoeuvre a record shows; 0 where it shows none, or has no ``delta`` or ``psi``.

    The longest of: the time between successive executes of the rudder; between successive extremes of heading to the
    same side; of a turning circle from the execute to 360 deg, and of a circle or pull-out that does not get there from
    the execute to the record's end. A swing still under way at the end counts for nothing.

    Raises:
        InputError: stamps are missing, or channel ``delta`` or ``psi`` holds fewer than two values.
    """
    if "delta" not in record or "psi" not in record:
        return 0.0
    if not np.isfinite(record.time).all():
        raise InputError(f"record '{record.name}': stamps are missing; rebuild its time base or use without_missing")
    seen = ObservedManoeuvre.from_record(record)
    at = record.time[reversals(seen.psi, max(MIN_REVERSAL, REVERSAL_SHARE * float(np.ptp(seen.psi))))[2:-2]]
    times = [np.diff(seen.executes), at[2:] - at[:-2]]
    if seen.kind in (ManoeuvreKind.TURNING_CIRCLE, ManoeuvreKind.PULL_OUT):
        times.append(np.array([_turn_seconds(seen)]))
    return float(np.max(np.concatenate(times), initial=0.0))


def _turn_seconds(observed: ObservedManoeuvre) -> float:
    execute = observed.longest_hold[1]
    turned = np.abs(observed.psi - observed.psi_at(execute))
    round_once = np.flatnonzero((observed.record.time > execute) & (turned >= FULL_CIRCLE))
    end = observed.record.time[round_once[0]] if len(round_once) else observed.record.time[-1]
    return float(end) - execute


def _seconds(record: Record) -> float:
    return record.duration


def _shortest(record: Record, rows: tuple[Index, ...]) -> Record:
    return min((record.rows(slice(fold[0], fold[-1] + 1)) for fold in rows), key=_seconds)


def _too_short(record: Record, piece: str, shortest: Record, longest: float) -> str:
    return (
        f"record '{record.name}': {piece} would be {shortest.duration:.4g} s long ({len(shortest)} samples), shorter "
        f"than the longest manoeuvre in the record, {longest:.4g} s"
    )


def _advise_share(record: Record, longest: float) -> str:
    """The shares of which both blocks are long enough, in hundredths."""
    time, count = record.time, len(record)
    fewest = int(np.searchsorted(time, time[0] + longest)) + 1
    most = int(np.searchsorted(time, time[-1] - longest, side="right")) - 1
    lowest, highest = math.ceil(100 * fewest / count), math.floor(100 * most / count)
    if lowest > highest:
        return "take a longer record"
    if lowest == highest:
        return f"take a share of {lowest / 100:.2f}"
    return f"take a share between {lowest / 100:.2f} and {highest / 100:.2f}"


def _advise_folds(record: Record, longest: float, count: int) -> str:
    most = min(count - 1, int(record.duration / longest))
    while most > 1 and _shortest(record, folds(len(record), most)).duration < longest:
        most -= 1
    return f"give {most} folds at most" if most > 1 else "take a longer record"


def _with_step(piece: Record, step: str) -> Record:
    return replace(piece, provenance=piece.provenance.with_step(step))
