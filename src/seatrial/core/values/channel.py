"""Channels of a record and where they come from; channels and time base out of a data frame."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from seatrial.core.values.arrays import BETWEEN, KINDS, Array, Between, Kind, Mask, frozen
from seatrial.core.values.errors import InputError, spelling_hint
from seatrial.core.values.notation import OPPOSITE, channel_hint, positive_direction, quantity, si_unit

if TYPE_CHECKING:
    import pandas


# One channel of a record, and where a record comes from.


@dataclass(frozen=True, eq=False)
class Channel:
    """Values of one quantity in SI units.

    Attributes:
        values: shape (n,), read-only.
        unit: SI unit.
        frame: ``body``, ``earth`` or ``none``.
        positive: positive direction, e.g. ``starboard`` or ``port``.
        reference_point: metres forward of midship to which the channel refers.
        label: the name in the file it came from.
        is_measured: shape (n,), False where nothing was measured and `values` only run on from sample to sample, as in
            lost rows or between the readings of a slower sensor; None: every finite value was measured.
        kind: who set it: an order (``command``, never corrected), a sensor (``measured``), or nobody says.
        between: how it runs between samples: ``held`` or ``straight``; empty: a command is held, of another one its
            steps decide.
        sample_s: s between the samples of its source; 0: as in the record.
    """

    values: Array
    unit: str
    frame: str
    positive: str
    reference_point: float = 0.0
    label: str = ""
    is_measured: Mask | None = None
    kind: Kind = ""
    between: Between = ""
    sample_s: float = 0.0

    @classmethod
    def from_notation(cls, symbol: str, values: Array) -> Self:
        """Return a channel in the notation table's own unit, frame and sign."""
        q = quantity(symbol)
        return cls(frozen(values), q.unit, q.frame, q.positive)

    @property
    def is_command(self) -> bool:
        """Whether it holds orders."""
        return self.kind == "command"

    @property
    def is_held(self) -> bool:
        """Whether it is declared to stay until the next sample; where nothing is declared, whether it is a command."""
        return self.between == "held" if self.between else self.is_command

    @property
    def metadata(self) -> dict[str, str | float]:
        """Everything but the values: ``Channel(values, **channel.metadata)`` is the channel again."""
        keys = ("unit", "frame", "positive", "reference_point", "label")
        more = {key: getattr(self, key) for key in ("kind", "between", "sample_s") if getattr(self, key)}
        return {key: getattr(self, key) for key in keys} | more

    @property
    def measured(self) -> Array:
        """The values, NaN where nothing was measured."""
        return self.values if self.is_measured is None else np.where(self.is_measured, self.values, np.nan)

    @property
    def readings(self) -> Array:
        """The values that were measured, in order."""
        return self.values if self.is_measured is None else self.values[self.is_measured]

    def with_values(self, values: Array) -> Self:
        """Return the channel with other values; of another number of samples all count as measured."""
        is_same_base = self.is_measured is not None and len(values) == len(self.is_measured)
        return replace(self, values=frozen(values), is_measured=self.is_measured if is_same_base else None)

    def with_measured(self, is_measured: Mask) -> Self:
        """Return the channel with what of it was measured, shape (n,)."""
        return replace(self, is_measured=None if bool(np.all(is_measured)) else np.array(is_measured, dtype=np.bool_))

    def rows(self, index: slice) -> Self:
        """Return the samples of a slice."""
        is_measured = None if self.is_measured is None else self.is_measured[index]
        return replace(self, values=self.values[index], is_measured=is_measured)


@dataclass(frozen=True)
class Provenance:
    """States the file a record comes from, its digest, and every step since."""

    source: str = ""
    sha256: str = ""
    steps: tuple[str, ...] = ()

    @classmethod
    def from_metadata(cls, metadata: Mapping[str, Any]) -> Self:
        """Restore what `dataclasses.asdict` gives, also after JSON."""
        return cls(metadata["source"], metadata["sha256"], tuple(metadata["steps"]))

    def with_step(self, step: str) -> Self:
        """Return the provenance with one more step."""
        return replace(self, steps=(*self.steps, step))


# Channels and time base out of the columns of a data frame, with what the caller declares about them.


_CHOICES: Mapping[str, tuple[str, ...]] = {"kind": KINDS, "between": BETWEEN}


@dataclass(frozen=True)
class ColumnDeclarations:
    """What is declared about the columns of a data frame, by channel symbol; the rest follows the notation table.

    Attributes:
        units: the unit of the numbers (``time`` for the time column); the SI unit where absent.
        frames: ``body``, ``earth`` or ``none``.
        positive: positive direction.
        reference_points: metres forward of midship.
        kind: ``command`` or ``measured``.
        between: ``held`` or ``straight`` between samples.
    """

    units: Mapping[str, str] = field(default_factory=dict)
    frames: Mapping[str, str] = field(default_factory=dict)
    positive: Mapping[str, str] = field(default_factory=dict)
    reference_points: Mapping[str, float] = field(default_factory=dict)
    kind: Mapping[str, str] = field(default_factory=dict)
    between: Mapping[str, str] = field(default_factory=dict)

    def require_symbols(self, symbols: list[str]) -> None:
        """Refuse a declaration about a channel that the frame does not hold.

        Raises:
            InputError: which argument names which unknown channel.
        """
        tables = {name: getattr(self, name) for name in ("units", "frames", "positive", "reference_points", *_CHOICES)}
        for argument, table in tables.items():
            for symbol in table:
                if symbol not in symbols and (argument, symbol) != ("units", "time"):
                    raise InputError(f"{argument} names the channel '{symbol}'{channel_hint(symbol, symbols)}")

    def channel(self, symbol: str, numbers: Array, label: str, metadata: Mapping[str, Any] | None) -> Channel:
        """Return the channel of a column in SI units; `metadata` as in `Channel.metadata` where the frame keeps it.

        Raises:
            InputError: no such symbol in the notation table, or a unit, frame or direction that does not fit it.
        """
        if metadata is None:
            frame = self.frames.get(symbol) or quantity(symbol).frame
            declared = Channel(
                frozen(numbers), quantity(symbol).unit, frame, positive_direction(symbol, frame), 0.0, label
            )
        else:
            declared = Channel(frozen(numbers), **metadata)
        frame = self.frames.get(symbol, declared.frame)
        if frame not in ("body", "earth", "none"):
            raise InputError(f"frames: '{symbol}' must be body, earth or none, not '{frame}'")
        positive = self.positive.get(symbol, declared.positive)
        if positive != declared.positive and positive != OPPOSITE.get(declared.positive):
            raise InputError(
                f"positive: '{symbol}' is {declared.positive} or {OPPOSITE.get(declared.positive, 'nothing else')}, "
                f"not '{positive}'"
            )
        chosen = {name: self._choice(name, symbol, getattr(declared, name)) for name in _CHOICES}
        values = numbers * _si_factor(symbol, self.units[symbol], declared.unit) if symbol in self.units else numbers
        place = self.reference_points.get(symbol, declared.reference_point)
        about = {**declared.metadata, "frame": frame, "positive": positive, "reference_point": place, **chosen}
        return Channel(frozen(values), **about)

    def _choice(self, argument: str, symbol: str, usual: str) -> str:
        """What is declared of a channel's kind, or of how it runs between samples."""
        word = getattr(self, argument).get(symbol, usual)
        if word and word not in _CHOICES[argument]:
            raise InputError(f"{argument}: '{symbol}' must be {' or '.join(_CHOICES[argument])}, not '{word}'")
        return word

    def seconds(self, stamps: "pandas.Index | pandas.Series") -> Array:
        """Return time stamps as s, shape (n,): numbers as they are, dates and durations from the first one.

        Raises:
            InputError: stamps that are neither numbers, dates nor durations, or a unit that is no time.
        """
        import pandas as pd

        index = pd.Index(stamps)
        if isinstance(index, pd.DatetimeIndex | pd.TimedeltaIndex):
            elapsed = pd.TimedeltaIndex(index - index[0])
            return np.asarray(elapsed.total_seconds(), dtype=np.float64)
        try:
            numbers = np.asarray(index, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError("the time stamps are neither numbers nor dates; use pandas.to_datetime") from None
        return numbers * _si_factor("time", self.units.get("time", "s"), "s")


def _si_factor(symbol: str, unit: str, expected: str) -> float:
    """Return the factor from a unit to the SI unit `expected`."""
    try:
        factor, si = si_unit(unit)
    except InputError as error:
        raise InputError(f"units: '{symbol}': {error}") from None
    if si != expected:
        raise InputError(f"units: '{symbol}' is measured in {expected}; unit '{unit}' does not fit")
    return factor


def channel_columns(
    frame: "pandas.DataFrame", time: str | None, columns: Mapping[str, str] | None
) -> Mapping[str, str]:
    """Return channel symbol -> column: those named, or every column but the time stamps.

    Raises:
        InputError: a named column is missing, or a column without a name among the symbols of the notation table.
    """
    present = [str(column) for column in frame.columns]
    for column in [*(columns or {}).values(), *([] if time is None else [time])]:
        if column not in present:
            raise InputError(f"the data frame has no column '{column}'{spelling_hint(column, present)}")
    return columns or {column: column for column in present if column != time}


def column_numbers(frame: "pandas.DataFrame", column: str) -> Array:
    """Return a column as numbers, shape (n,); empty cells are NaN.

    Raises:
        InputError: a cell that is not a number.
    """
    try:
        return frame[column].to_numpy(np.float64)
    except (TypeError, ValueError):
        raise InputError(f"column '{column}' of the data frame holds text; convert it with pandas.to_numeric") from None
