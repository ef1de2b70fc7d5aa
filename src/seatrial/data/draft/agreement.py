"""Guesses of several runs made one: what one run shows holds for all, what two runs contradict stays open."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from seatrial.data.draft.column_guess import RELATIVE, ColumnGuess


def agreed_guesses(
    parts: Sequence[Sequence[ColumnGuess]], examined: Sequence[Sequence[Sequence[ColumnGuess]]]
) -> tuple[tuple[ColumnGuess, ...], ...]:
    """Return the guesses of the sources of one run as the runs that were examined decide them, column by column."""
    known: dict[tuple[str, str], list[ColumnGuess]] = {}
    for run in examined:
        for guess in (g for part in run for g in part if g.is_used):
            known.setdefault(_key(guess), []).append(guess)
    return tuple(tuple(_agreed(g, known.get(_key(g), ())) for g in part) for part in parts)


def _key(guess: ColumnGuess) -> tuple[str, str]:
    """The name of a column without its topic, as runs that are sheets of a workbook have it, and its channel.

    A wind that a run shows to be an apparent one is the same column.
    """
    return str(guess.source).rpartition("/")[2], guess.symbol.removesuffix(RELATIVE)


def _agreed(guess: ColumnGuess, readings: Sequence[ColumnGuess]) -> ColumnGuess:
    decided = [reading for reading in readings if not reading.is_open]
    first = next(iter(decided or readings), guess)
    if len({_meaning(one) for one in decided}) > 1:
        other = "; another run shows ".join(_different(decided))
        return replace(
            first, source=guess.source, other_reading=f"{other}: the runs contradict each other", is_used=guess.is_used
        )
    return replace(first, source=guess.source, is_used=guess.is_used)


def _meaning(guess: ColumnGuess) -> tuple[str, str, str]:
    return guess.unit, guess.frame, guess.positive


def _different(guesses: Iterable[ColumnGuess]) -> list[str]:
    """What each reading that differs from the first says."""
    first, *rest = dict.fromkeys(map(_meaning, guesses))
    keys = ("unit", "frame", "positive")
    return [
        ", ".join(f'{key} = "{new}"' for key, old, new in zip(keys, first, one, strict=True) if new != old)
        for one in rest
    ]
