"""How a file is laid out: which column is which quantity, in which unit, frame, sign and place."""

from dataclasses import dataclass
from typing import Literal

from seatrial.core.values import InputError, quantity, si_unit
from seatrial.core.values.notation import positive_direction

Separator = Literal["auto", ",", ";", "tab", "whitespace"]

_FRAME_NAMES = ("body", "earth", "none")


@dataclass(frozen=True)
class ColumnSpec:
    """One column of a file and what it holds.

    Attributes:
        symbol: the notation table's symbol (``time`` for the time column).
        source: column name, or its number counted from 1.
        unit: the unit in the file.
        frame: ``body``, ``earth`` or ``none``; empty: the notation table's.
        positive: positive direction; empty: the notation table's (north and east for earth-fixed velocities).
        reference_point: metres forward of midship, at the scale of the file.
        label: the name to keep; empty: the file's own, or ``column k``.
    """

    symbol: str
    source: str | int
    unit: str
    frame: str = ""
    positive: str = ""
    reference_point: float = 0.0
    label: str = ""

    @property
    def display_name(self) -> str:
        """How messages name the column."""
        return f"column {self.source}" if isinstance(self.source, int) else f"column '{self.source}'"

    @property
    def declared_frame(self) -> str:
        """The frame in force.

        Raises:
            InputError: neither ``body``, ``earth`` nor ``none``.
        """
        frame = self.frame or quantity(self.symbol).frame
        if frame not in _FRAME_NAMES:
            raise InputError(f"channel '{self.symbol}': frame must be body, earth or none, not '{frame}'")
        return frame

    @property
    def declared_positive(self) -> str:
        """The positive direction in force."""
        return self.positive or positive_direction(self.symbol, self.declared_frame)

    def si_factor(self, expected: str) -> float:
        """Factor from the file's unit to the SI unit `expected`.

        Raises:
            InputError: the unit is unknown or measures something else.
        """
        try:
            factor, unit = si_unit(self.unit)
        except InputError as error:
            raise InputError(f"channel '{self.symbol}': {error}") from None
        if unit != expected:
            raise InputError(f"channel '{self.symbol}' is measured in {expected}; unit '{self.unit}' does not fit")
        return factor


@dataclass(frozen=True)
class Layout:
    """The layout of one kind of file.

    Attributes:
        format: which reader opens it.
        time: the time column.
        columns: the other columns that are wanted.
        header_lines: lines before the first data line of a text file; the last of them holds the names. With named
            columns and 0, the first line holds the names.
        encoding: of a text file.
        separator: between the cells of a text file; ``auto`` looks at the first data line.
        decimal: decimal sign of a text file.
        scale: length ratio by which the record is Froude-scaled; 1 leaves it as it is.
    """

    format: str
    time: ColumnSpec
    columns: tuple[ColumnSpec, ...]
    header_lines: int = 0
    encoding: str = "utf-8"
    separator: Separator = "auto"
    decimal: str = "."
    scale: float = 1.0

    def __post_init__(self) -> None:
        symbols = [column.symbol for column in self.columns]
        twice = sorted({symbol for symbol in symbols if symbols.count(symbol) > 1})
        if twice:
            raise InputError(f"channel '{twice[0]}' is given twice; keep one column for each channel")
        if self.decimal not in (".", ","):
            raise InputError(f"decimal sign must be '.' or ',', not '{self.decimal}'")
        if self.header_lines < 0:
            raise InputError(f"header_lines must be 0 or more, not {self.header_lines}")

    @property
    def has_named_columns(self) -> bool:
        """Whether some column is wanted by name."""
        return any(isinstance(column.source, str) for column in (self.time, *self.columns))
