"""Of which point the velocities of a log are where the antenna's place is stated: of the antenna, or of midship."""

from collections.abc import Sequence
from dataclasses import replace

from seatrial.core.values import Record
from seatrial.data.check.motion import recorded_motion
from seatrial.data.draft.column_guess import ColumnGuess

_VELOCITIES = frozenset({"u", "v"})


def with_velocities_of_antenna(
    runs: Sequence[Sequence[Sequence[ColumnGuess]]], records: Sequence[Record | None], antenna: float | None
) -> list[tuple[tuple[ColumnGuess, ...], ...]]:
    """Return the guesses of each run's sources, velocities that change the positions as the antenna's own.

    records: of each run, whose positions are the antenna's; antenna: m forward of midship; None: not stated.
    """
    if not antenna or not _are_of_antenna(records, antenna):
        return [tuple(map(tuple, parts)) for parts in runs]
    return [tuple(tuple(_of_antenna(one, antenna) for one in part) for part in parts) for parts in runs]


def _are_of_antenna(records: Sequence[Record | None], antenna: float) -> bool:
    """Whether the derivative of the positions fits the velocities better as they are than moved from midship."""
    here, midship = 0.0, 0.0
    for record in records:
        as_recorded = None if record is None else recorded_motion(record)
        moved = None if record is None or as_recorded is None else recorded_motion(_with_positions_at(record, antenna))
        if as_recorded is not None and moved is not None:
            here += as_recorded.misfit(as_recorded.conventions[0])
            midship += moved.misfit(moved.conventions[0])
    return here < midship


def _with_positions_at(record: Record, place: float) -> Record:
    for symbol in ("x0", "y0"):
        record = record.with_channel(symbol, replace(record.channel(symbol), reference_point=place))
    return record


def _of_antenna(guess: ColumnGuess, antenna: float) -> ColumnGuess:
    if not (guess.is_used and guess.symbol in _VELOCITIES and guess.follows_track):
        return guess
    return replace(guess, reference_point=antenna).with_evidence("of the antenna, as the positions are")
