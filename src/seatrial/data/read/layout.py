"""How a file is laid out: which column is which quantity, in which unit, frame, sign and place."""

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from seatrial.core.values import Array, InputError, channel_hint, quantity, si_unit
from seatrial.core.values.arrays import Between, Kind
from seatrial.core.values.notation import NOTATION, TWIN_DIFFERENCES, Quantity, positive_direction

# What a column of a log may be besides a channel of a record: measurements from which channels are derived.

_TABLE = (
    Quantity("lat", "latitude", "rad", "earth", "north", r"\varphi", "latitude"),
    Quantity("lon", "longitude", "rad", "earth", "east", r"\lambda", "longitude"),
    Quantity("sog", "speed over ground", "m/s", "earth", "none", "U_g", "platform_speed_wrt_ground"),
    Quantity("cog", "course over ground", "rad", "earth", "starboard", r"\chi", "platform_course"),
    Quantity("stw", "speed through water", "m/s", "body", "forward", "u_w", "platform_speed_wrt_sea_water"),
    Quantity("psi_magnetic", "heading from magnetic north", "rad", "earth", "starboard", r"\psi_m", "platform_yaw"),
    Quantity("variation", "magnetic variation", "rad", "earth", "east", "V", "magnetic_variation"),
    *(Quantity(f"q_{k}", f"component {k} of the attitude quaternion", "1", "earth", "none", f"q_{k}", f"quaternion_{k}")
      for k in "wxyz"),
)  # fmt: skip
LOG_QUANTITIES: dict[str, Quantity] = {one.symbol: one for one in _TABLE}


def log_quantity(symbol: str) -> Quantity:
    """Return the entry of a channel, or of a measurement from which channels are derived.

    Raises:
        InputError: there is none; what to write for a common name, or the nearest symbol.
    """
    if symbol in LOG_QUANTITIES:
        return LOG_QUANTITIES[symbol]
    if symbol in NOTATION:
        return quantity(symbol)
    raise InputError(f"unknown channel '{symbol}'{channel_hint(symbol, sorted({*NOTATION, *LOG_QUANTITIES}))}")


# How a file is laid out: which column is which quantity, in which unit, frame, sign and place.

Separator = Literal["auto", ",", ";", "tab", "whitespace"]

_FRAME_NAMES = ("body", "earth", "none", "enu")
# units of time stamps that are not a number of seconds, see `seatrial.data.read.clock`
TEXT_CLOCKS = ("utc", "hhmmss", "excel", "gnss")


@dataclass(frozen=True)
class ColumnSpec:
    """One column of a file and what it holds.

    Attributes:
        symbol: the notation table's symbol (``time`` for the time column).
        source: column name, or its number counted from 1.
        unit: the unit in the file.
        frame: ``body``, ``earth`` or ``none``; empty: the notation table's. ``enu``: x east, y north, z up, angles
            counter-clockwise from east, as ROS has it.
        positive: positive direction; empty: the notation table's (north and east for earth-fixed velocities).
        reference_point: metres forward of midship, at the scale of the file.
        label: the name to keep; empty: the file's own, or ``column k``.
        zero, span, factor, offset: the number in `unit` is (cell - zero) / span * factor + offset.
        twin: column of the other of two rudders, nozzles, buckets or shafts, that to starboard: the channel is half the
            sum, or the difference where it is one of `TWIN_DIFFERENCES`; empty: there is none.
        kind: who set it: an order (``command``), a sensor (``measured``), or nobody says.
        between: how it runs between samples, ``held`` or ``straight``; empty: a command is held.
        declared: what the trial file declares a channel of its own to be; None: the notation table has it.
    """

    symbol: str
    source: str | int
    unit: str
    frame: str = ""
    positive: str = ""
    reference_point: float = 0.0
    label: str = ""
    zero: float = 0.0
    span: float = 1.0
    factor: float = 1.0
    offset: float = 0.0
    twin: str | int = ""
    kind: Kind = ""
    between: Between = ""
    declared: Quantity | None = None

    @property
    def is_held(self) -> bool:
        """Whether a value holds until the next one, in place of a straight line between them."""
        return self.between == "held" if self.between else self.kind == "command"

    @property
    def is_difference(self) -> bool:
        """Whether it is what two columns differ by, the first less its twin."""
        return self.symbol in TWIN_DIFFERENCES.values()

    def of_twins(self, first: Array, second: Array) -> Array:
        """Return half the sum of the cells of two columns (n,), or what they differ by where that is the channel.

        Where one is empty the other counts for both.
        """
        pair = np.stack([first, second])
        filled = np.isfinite(pair)
        is_empty = ~filled.any(axis=0)
        if self.is_difference:
            return np.where(is_empty, np.nan, np.where(filled.all(axis=0), first - second, 0.0))
        return np.where(filled, pair, 0.0).sum(axis=0) / np.where(is_empty, np.nan, filled.sum(axis=0))

    @property
    def difference(self) -> "ColumnSpec":
        """What twins differ by, to be read as their mean is; zeros cancel, and a turned angle has a turned difference.

        Of a column of a channel of `TWIN_DIFFERENCES` that has a twin.
        """
        sign = 1.0 if self.declared_positive == self.quantity.positive else -1.0
        symbol = TWIN_DIFFERENCES[self.symbol]
        return replace(self, symbol=symbol, positive="", label="", zero=0.0, factor=sign * self.factor, offset=0.0)

    @property
    def quantity(self) -> Quantity:
        """What the symbol means.

        Raises:
            InputError: as `log_quantity`.
        """
        return self.declared or log_quantity(self.symbol)

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
        frame = self.frame or self.quantity.frame
        if frame not in _FRAME_NAMES:
            raise InputError(f"channel '{self.symbol}': frame must be body, earth, none or enu, not '{frame}'")
        return frame

    @property
    def declared_positive(self) -> str:
        """The positive direction in force."""
        if self.declared is not None:
            return self.declared.positive
        if self.positive or self.symbol not in NOTATION:
            return self.positive or self.quantity.positive
        return positive_direction(self.symbol, self.declared_frame)

    def in_si(self, cells: Array) -> Array:
        """Return the numbers of the file in the SI unit of the channel; a declared one points as it is declared.

        Raises:
            InputError: as `si_factor`.
        """
        expected = self.quantity.unit
        # a share of a span has no unit: that of the cells is then only a label, such as "us" of a pulse width
        size = 1.0 if self.span != 1.0 and expected == "1" else self.si_factor(expected)
        if self.declared is not None and self.positive not in ("", self.declared.positive):
            size = -size
        if (self.zero, self.span, self.factor, self.offset) == (0.0, 1.0, 1.0, 0.0):
            return cells if size == 1.0 else cells * size
        return ((cells - self.zero) / self.span * self.factor + self.offset) * size

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
class TimeSpec(ColumnSpec):
    """The column of time stamps, and what completes them.

    Attributes:
        date: column of dates, where `source` holds the time of day.
        nanoseconds: column of nanoseconds, where `source` holds whole seconds.
        week: column of GNSS weeks, where `source` holds seconds of the week.
        clock_offset: s to be added to the stamps.
    """

    date: str | int = ""
    nanoseconds: str | int = ""
    week: str | int = ""
    clock_offset: float = 0.0


@dataclass(frozen=True)
class Geometry:
    """What positions, velocities and headings are derived with.

    Attributes:
        origin: latitude and longitude [rad] of the plane on which x0 and y0 lie; None: the first fix.
        variation: magnetic variation [rad], positive to the east; None: it is not stated.
        antenna_x, antenna_y: m forward of midship and to starboard of the centre line: where the GNSS antenna is.
        is_antenna_stated: whether somebody said so; else it is taken to be there.
    """

    origin: tuple[float, float] | None = None
    variation: float | None = None
    antenna_x: float = 0.0
    antenna_y: float = 0.0
    is_antenna_stated: bool = False


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
        scale: length ratio by which the record is Froude-scaled; 1 leaves it as it is.
        geometry: what positions and headings are derived with.
        rate: Hz of the common time base of columns from several topics; None: that of the slowest measured one.
    """

    format: str
    time: ColumnSpec | TimeSpec
    columns: tuple[ColumnSpec, ...]
    header_lines: int = 0
    encoding: str = "utf-8"
    separator: Separator = "auto"
    scale: float = 1.0
    geometry: Geometry = Geometry()
    rate: float | None = None

    def __post_init__(self) -> None:
        symbols = [column.symbol for column in self.columns]
        twice = sorted({symbol for symbol in symbols if symbols.count(symbol) > 1})
        if twice:
            raise InputError(f"channel '{twice[0]}' is given twice; keep one column for each channel")
        if self.header_lines < 0:
            raise InputError(f"header_lines must be 0 or more, not {self.header_lines}")

    def with_differences(self, symbols: Collection[str]) -> "Layout":
        """Return the layout with what twins differ by, where that is among these symbols and has no column yet."""
        wanted = {*symbols} - {column.symbol for column in self.columns}
        twins = [column for column in self.columns if column.twin and TWIN_DIFFERENCES.get(column.symbol) in wanted]
        return replace(self, columns=(*self.columns, *(column.difference for column in twins)))

    @property
    def has_named_columns(self) -> bool:
        """Whether some column is wanted by name; a number in quotes is one of a column."""
        sources = [
            self.time.source,
            *(name for column in self.columns for name in (column.source, column.twin) if name),
        ]
        return any(isinstance(source, str) and not source.isdecimal() for source in sources)
