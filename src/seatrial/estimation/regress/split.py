"""A record in pieces, to fit on some and judge on others: contiguous blocks and folds, and what shuffling gives away.

Neighbouring samples of a motion are nearly the same sample. Blocks follow Song et al. 2025
(doi 10.19693/j.issn.1673-3185.03832), eq. (9), in the order of time; a piece shorter than the record's longest
manoeuvre would not hold one whole, and is refused.
"""

import math
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, Index, InputError, Record
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, ObservedManoeuvre

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
    at = record.time[reversals(seen.psi, max(MIN_REVERSAL, REVERSAL_SHARE * float(np.ptp(seen.psi))))]
    times = [np.diff(seen.executes), at[2:] - at[:-2]]
    if seen.kind in (ManoeuvreKind.TURNING_CIRCLE, ManoeuvreKind.PULL_OUT):
        times.append(np.array([_turn_seconds(seen)]))
    return float(np.max(np.concatenate(times), initial=0.0))


def reversals(values: Array, least: float) -> Index:
    """Rows of the extremes of a course of values, shape (n,), after each of which it goes back by `least` or more.

    Maxima and minima alternate; the ends are none, nor is the first extreme unless it was approached by `least`.
    """
    found: list[int] = []
    low = high = top = 0
    side = 0
    for row, value in enumerate(values.tolist()):
        if side == 0:
            low = row if value < values[low] else low
            high = row if value > values[high] else high
            if values[high] - values[low] >= least:
                side, top = (1, high) if high > low else (-1, low)
        elif side * (value - values[top]) > 0.0:
            top = row
        elif side * (values[top] - value) >= least:
            found.append(top)
            side, top = -side, row
    return np.array(found, dtype=np.int64)


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
