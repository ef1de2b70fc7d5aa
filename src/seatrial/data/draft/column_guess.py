"""What one column is taken for, with the evidence; guesses of several runs made one."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from seatrial.core.values import Record
from seatrial.data.check.motion import recorded_motion
from seatrial.data.read import ColumnSpec

# What one column is taken for, with the evidence.

_TOPIC = re.compile(r"^[^\[(]*/")  # before the name of a column; not what stands in brackets behind it: [m/s]
RELATIVE = "_relative"
"""The end of the channels of an apparent wind."""


@dataclass(frozen=True)
class ColumnGuess:
    """What one column is taken for.

    Attributes:
        source: as the trial file addresses it.
        symbol, unit, frame, positive, zero, span, scale, offset, kind: as in a channel of the trial file.
        evidence: why.
        other_reading: what it may be instead; empty: it is assigned outright.
        side: of the craft on which the motion or a name shows a thruster or shaft, port or starboard; empty: not shown.
        twin: the column of the other of two rudders, nozzles or shafts, of which half the sum is taken; empty: none.
        reference_point: m forward of midship to which it refers; 0: midship, or not examined.
        follows_track: whether the motion shows a velocity to be the derivative of the position, over ground.
        is_used: whether it is the one chosen for its symbol.
        unused_because: why it is not; empty: it is used.
        is_assumed: whether nothing that is measured shows its side or zero, and the usual one is taken.
        is_documented: whether the documentation of its logger says what it is.
        is_commented: whether its line is a comment, as the model does not take it.
        candidates: other readings as keys of a trial file, each with the nats by which the records speak against it.
    """

    source: str | int
    symbol: str
    unit: str
    frame: str = ""
    positive: str = ""
    zero: float = 0.0
    span: float = 1.0
    scale: float = 1.0
    kind: str = ""
    evidence: tuple[str, ...] = ()
    other_reading: str = ""
    side: str = ""
    reference_point: float = 0.0
    follows_track: bool = False
    is_used: bool = True
    unused_because: str = ""
    is_commented: bool = False
    is_documented: bool = False
    is_assumed: bool = False
    offset: float = 0.0
    twin: str | int = ""
    candidates: tuple[tuple[str, float], ...] = ()

    @property
    def topic(self) -> str:
        """The topic before the name of the column, with its stroke; empty for a plain table."""
        match = _TOPIC.match(str(self.source))
        return match[0] if match else ""

    @property
    def is_open(self) -> bool:
        """Whether a person must choose."""
        return bool(self.other_reading)

    @property
    def is_of_wind(self) -> bool:
        """Whether it is wind, which a draft may leave out: without it the air is taken for calm."""
        return self.symbol.startswith("wind_")

    @property
    def column(self) -> ColumnSpec:
        """The column as a layout has it."""
        return ColumnSpec(
            self.symbol,
            self.source,
            self.unit,
            self.frame,
            self.positive,
            self.reference_point,
            zero=self.zero,
            span=self.span,
            factor=self.scale,
            offset=self.offset,
            twin=self.twin,
            kind="command" if self.kind == "command" or self.symbol.startswith("command_") else "",
        )

    def with_evidence(self, text: str) -> "ColumnGuess":
        """Return the guess with one more reason."""
        return replace(self, evidence=(*self.evidence, text))


Changes = Mapping[str, Callable[[ColumnGuess], ColumnGuess]]
"""Channel -> what its guess becomes."""


# Guesses of several runs made one: what one run shows holds for all, what two runs contradict stays open.


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
    return _TOPIC.sub("", str(guess.source)), guess.symbol.removesuffix(RELATIVE)


def _agreed(guess: ColumnGuess, readings: Sequence[ColumnGuess]) -> ColumnGuess:
    decided = [reading for reading in readings if not reading.is_open]
    first = next(iter(decided or readings), guess)
    if len({_meaning(one) for one in decided}) > 1:
        other = "; another run shows ".join(_different(decided))
        first = replace(first, other_reading=f"{other}: the runs contradict each other")
    return replace(first, source=guess.source, twin=guess.twin, is_used=guess.is_used)


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


# Of which point the velocities of a log are where the antenna's place is stated: of the antenna, or of midship.

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
            here += as_recorded.misfit
            midship += moved.misfit
    return here < midship


def _with_positions_at(record: Record, place: float) -> Record:
    for symbol in ("x0", "y0"):
        record = record.with_channel(symbol, replace(record.channel(symbol), reference_point=place))
    return record


def _of_antenna(guess: ColumnGuess, antenna: float) -> ColumnGuess:
    if not (guess.is_used and guess.symbol in _VELOCITIES and guess.follows_track):
        return guess
    return replace(guess, reference_point=antenna).with_evidence("of the antenna, as the positions are")
