"""What every reader returns: the topics of a log as tables of cells, before anything is known about them."""

import importlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType, ModuleType

import numpy as np

from seatrial.core.text.words import printable
from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.core.values.notation import is_unit
from seatrial.data.read.layout import ColumnSpec, Layout

# Angles as navigators write them: degrees with minutes and seconds, and the side of the world.

_SIXTIETH = 60.0  # minutes of a degree, seconds of a minute
_HALF_TURN, _TWO_DIGITS = 180.0, 100.0  # deg; of the minutes behind the degrees in NMEA 0183's dddmm.mmmm
_NUMBER = r"\d+(?:[.,]\d+)?"
_ANGLE = re.compile(
    rf"(?P<before>[NSEW])?\s*(?P<deg>{_NUMBER})\s*[°ºd ]?\s*"
    rf"(?:(?P<min>{_NUMBER})\s*['′’m]?\s*)?(?:(?P<sec>{_NUMBER})\s*(?:\"|″|”|''|s)?\s*)?(?P<after>[NSEW])?",
    re.IGNORECASE,
)


def degrees_of(text: str) -> float | None:
    """Return an angle with its side in decimal degrees, north and east positive; None for text that is none.

    `54°06.00049'N`, `7 54 00.2 E`, `S 12.5`, `5406.00049N`; the side, before or behind, is what marks it.
    """
    match = _ANGLE.fullmatch(text.strip())
    if match is None or bool(match["before"]) == bool(match["after"]):
        return None
    degrees, minutes, seconds = (float((match[part] or "0").replace(",", ".")) for part in ("deg", "min", "sec"))
    if degrees > _HALF_TURN and not match["min"]:
        degrees, minutes = divmod(degrees, _TWO_DIGITS)
    if max(minutes, seconds) >= _SIXTIETH:
        return None
    sign = -1.0 if (match["before"] or match["after"]).upper() in "SW" else 1.0
    return sign * (degrees + minutes / _SIXTIETH + seconds / _SIXTIETH**2)


def with_sides(cells: Sequence[Sequence | np.ndarray]) -> tuple[Sequence | np.ndarray, ...]:
    """Return the columns of a table, angles with the letters of the side that stand in the column behind each.

    ``54 48.7004`` before ``N`` becomes ``54 48.7004 N``, ``5448.7004`` before ``S`` likewise; the letters stay.
    """
    joined = list(cells)
    for k, sides in enumerate(cells[1:]):
        if isinstance(sides, np.ndarray) or not _are_sides(sides):
            continue
        angles = [f"{angle} {side}".strip() for angle, side in zip(cells[k], sides, strict=True)]
        if all(degrees_of(text) is not None for text in angles if text):
            joined[k] = angles
    return tuple(joined)


def _are_sides(cells: Sequence) -> bool:
    """Whether a column holds nothing but N and S, or E and W; a cell may be empty."""
    letters = {str(cell).strip().upper() for cell in cells} - {""}
    return bool(letters) and (letters <= {"N", "S"} or letters <= {"E", "W"})


# Names and units of a table's columns, from the rows above its numbers.

_BRACKETS = "[]() "
_COMMENT_MARKS = ("#", "%", "//")
_LEAST_UNITS = (
    0.5  # of the cells of a row of units that must be ones: units that nobody converts stand there too; chosen
)


@dataclass(frozen=True)
class TableHeader:
    """Names of the columns, and their units where a row of its own states them; else `units` is empty."""

    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    def names_of(self, width: int) -> tuple[str, ...]:
        """The names of a table of so many columns; empty text for those without one."""
        return (*self.names[:width], *[""] * (width - len(self.names)))

    def units_of(self, width: int) -> tuple[str, ...]:
        """As `names_of`; empty where no unit is stated."""
        return (*self.units[:width], *[""] * (width - len(self.units))) if self.units else ()


def table_header(rows: Sequence[Sequence[str]], width: int = 0) -> TableHeader:
    """Return the header from the rows above the numbers: the last one, or the last two where the last holds units.

    Rows without text are passed over, and a mark of a comment before the first name is taken off. A cell is a unit
    where it is known as one or stands in brackets. Names of groups in the row right above go on to the next group and
    stand before those of their columns: ``Rudder port``.

    width: columns of the table; 0: as many as the header has.
    """
    places = [place for place, row in enumerate(rows) if any(row)]
    if not places:
        return TableHeader()
    filled = [_without_mark(rows[place], width) for place in places]
    units: tuple[str, ...] = ()
    names, last = filled[-2:][0], filled[-1]
    if len(filled) > 1 and len(names) == len(last) and _unit_share(last) >= max(_LEAST_UNITS, _unit_share(names)):
        units = tuple(cell.strip(_BRACKETS) for cell in last)
        filled.pop()
    names, place = filled[-1], places[len(filled) - 1]
    if len(filled) > 1 and places[len(filled) - 2] == place - 1 and _are_groups(filled[-2], names):
        names = _with_groups(filled[-2], names, has_units=bool(units))
    return TableHeader(tuple(names), units)


def _without_mark(row: Sequence[str], width: int) -> Sequence[str]:
    """The cells of a header that stands in a comment, without its mark."""
    if row[0] in _COMMENT_MARKS and len(row) == width + 1:
        return row[1:]
    bare = row[0].lstrip("".join(_COMMENT_MARKS)).strip()
    return row if bare == row[0] or not bare else [bare, *row[1:]]


def _are_groups(groups: Sequence[str], names: Sequence[str]) -> bool:
    """Whether a row holds names of groups of columns: not a title, settings or a full row of other names."""
    filled = [cell for cell in groups if cell]
    is_text = not any(_PLAIN_NUMBER.fullmatch(cell) or cell.endswith(":") for cell in filled)
    spans = "" in groups[1:] or len(set(names)) < len(names)
    return len(groups) == len(names) and len(filled) > 1 and is_text and spans


def _with_groups(groups: Sequence[str], names: Sequence[str], *, has_units: bool) -> Sequence[str]:
    """The names behind those of the groups above them; of a group of one column its own name, if it has one.

    has_units: whether a row of its own states the units, so that a name such as RPM is none.
    """
    group, joined = "", list[str]()
    for k, (above, name) in enumerate(zip(groups, names, strict=True)):
        is_alone = bool(above) and (k + 1 == len(groups) or bool(groups[k + 1]))
        group = above or (group if name else "")
        names_unit = is_unit(name) and not has_units
        if is_alone and name and names.count(name) == 1 and not names_unit:
            joined.append(name)
        else:
            joined.append(f"{group} [{name}]" if names_unit else f"{group} {name}".strip())
    return joined


def _unit_share(cells: Sequence[str]) -> float:
    filled = [cell for cell in cells if cell]
    units = [cell.startswith(("[", "(")) or is_unit(cell) for cell in filled]
    return sum(units) / len(units) if units else 0.0


# Libraries that only some formats need.

_LONGEST_FAULT = 120  # letters of a library's message in ours; ours: some explain at length


def require_library(module: str, file: str, kind: str, extra: str) -> ModuleType:
    """Import a library of an extra; `kind` says what the file is, such as "a ROS bag".

    Raises:
        InputError: it is not installed; the sentence says how to.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        library = module.partition(".")[0]
        raise InputError(
            f"{file} is {kind}, which needs {library}; install it with: pip install 'seatrial[{extra}]'"
        ) from None


def fault_text(error: Exception) -> str:
    """Return what a library says of a damaged file: the kind of its error, and the beginning of its first line."""
    first = next(iter(str(error).splitlines()), "")
    return f"{type(error).__name__}: {printable(first, _LONGEST_FAULT)}"


# One table of a log: named columns of cells, before anything is known about them.

EMPTY_CELLS = ("", "na", "n/a", "null", "none")
_PLAIN_NUMBER = re.compile(
    r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?(nan|inf|infinity)|true|false", re.IGNORECASE | re.ASCII
)
_GROUPED_NUMBER = re.compile(r"[+-]?\d{1,3}([,.' ]\d{3})+([.,]\d*)?")
_MINUS_SIGN = "\u2212"
_LARGEST_CELL = 1e40  # in any unit; ours: beyond every 32-bit float, with which logs mark readings that stand for none
_LONGEST_CELL = 40  # characters of a cell that a message quotes; ours


@dataclass(frozen=True)
class RawTable:
    """Columns of one file, or of one topic in it.

    Attributes:
        file: file name for messages.
        names: column names; empty strings where the file has none.
        cells: one sequence for each column, numbers or text, all of the same length.
        first_row: line (or row) number of the first cell.
        topic: name of the topic; empty for a plain table.
        units: of the columns as the file states them, empty strings where it does not; empty: it states none.
        time_name: the column of time stamps where the format defines one.
    """

    file: str
    names: tuple[str, ...]
    cells: tuple[Sequence | np.ndarray, ...]
    first_row: int = 1
    topic: str = ""
    units: tuple[str, ...] = ()
    time_name: str = ""

    def __len__(self) -> int:
        return len(self.cells[0]) if self.cells else 0

    @property
    def units_of_columns(self) -> tuple[str, ...]:
        """Units of all columns, empty where the file states none."""
        return self.units or ("",) * len(self.names)

    def column_index(self, column: ColumnSpec) -> int:
        """Position of a wanted column.

        Raises:
            InputError: there is no such column; the nearest one is named.
        """
        if column.symbol == "time" and not column.source:
            return self._time_index()
        if isinstance(column.source, int) or (column.source.isdecimal() and column.source not in self.names):
            number = int(column.source)
            if not 1 <= number <= len(self.cells):
                raise InputError(
                    f"{self.file}: channel '{column.symbol}' wants column {number}, "
                    f"but the file has {len(self.cells)} columns; columns count from 1"
                )
            return number - 1
        name = column.source if column.source in self.names else column.source.removeprefix(self.topic).lstrip("/")
        if name not in self.names:
            known = [name for name in self.names if name]
            hint = spelling_hint(name, known) if known else "; the file has no column names, give numbers"
            raise InputError(f"{self.file}: no column '{column.source}' for channel '{column.symbol}'{hint}")
        places = [k + 1 for k, one in enumerate(self.names) if one == name]
        if len(places) > 1:
            raise InputError(
                f"{self.file}: the header has '{name}' {len(places)} times; for channel '{column.symbol}' give the "
                f"number of the column: column = {' or '.join(map(str, places))}"
            )
        return places[0] - 1

    def _time_index(self) -> int:
        if not self.time_name:
            raise InputError(f"{self.title} has no time stamps of its own; name the column with time = {{ column = }}")
        return self.names.index(self.time_name)

    @property
    def title(self) -> str:
        """How messages name the table."""
        return f"{self.file}, topic '{self.topic}'" if self.topic else self.file

    def label(self, column: ColumnSpec) -> str:
        """The name kept with the channel: the user's, the file's, or ``column k``."""
        index = self.column_index(column)
        return column.label or self.names[index] or f"column {index + 1}"

    def numbers(self, column: ColumnSpec) -> Array:
        """The cells of a column as numbers, shape (n,); empty cells are NaN, 54°06.5'N is 54.108 (degrees).

        Of twins as `ColumnSpec.of_twins` has it.

        Raises:
            InputError: no such column, or a cell that is not a finite number (row and column named).
        """
        if column.twin:
            pair = [self.numbers(replace(column, source=name, twin="")) for name in (column.source, column.twin)]
            return column.of_twins(*pair)
        cells = self.cells[self.column_index(column)]
        if isinstance(cells, np.ndarray) and cells.dtype.kind in "fiub":
            values = np.asarray(cells, dtype=np.float64)
        else:
            values = np.array([self._to_number(cell, row, column) for row, cell in enumerate(cells)])
        endless = np.flatnonzero(np.abs(values) > _LARGEST_CELL)
        if endless.size:
            raise InputError(
                f"{self.file}: row {self.first_row + endless[0]}, {column.display_name}: the number is infinite, or as "
                "good as; leave the cell empty"
            )
        return values

    def first_text_row(self, index: int) -> int | None:
        """Return the first row, from 0, in which a column holds what is no number; None where there is none."""
        for row, cell in enumerate(self.cells[index]):
            try:
                self._to_number(cell, row, ColumnSpec("column", index + 1, ""))
            except InputError:
                return row
        return None

    def _to_number(self, cell: object, row: int, column: ColumnSpec) -> float:
        if cell is None or (isinstance(cell, str) and cell.strip().lower() in EMPTY_CELLS):
            return np.nan
        text = str(cell).strip().replace(_MINUS_SIGN, "-")
        if _PLAIN_NUMBER.fullmatch(text):
            return float(text[0] in "tT") if text[0] in "tTfF" else float(text)
        angle = degrees_of(text)
        if angle is not None:
            return angle
        where = f"{self.file}: row {self.first_row + row}, {column.display_name}: '{text[:_LONGEST_CELL]}'"
        if _GROUPED_NUMBER.fullmatch(text):
            raise InputError(f"{where} has a thousands separator; write the file without")
        raise InputError(f"{where} is not a number; check header_lines and separator")


# Units that stand behind each number of a column, as in spreadsheets and transcripts of a bridge.

_WITH_UNIT = re.compile(rf"([+-]?{_NUMBER})\s*([^\d\s.,+-]\S*)")
_REFERENCES = {"T": "true", "M": "magnetic"}
"""Letters behind an angle, and what they say of it (NMEA 0183, sentences HDT, HDM and VHW)."""


def number_and_unit(text: str) -> tuple[str, str] | None:
    """Return the number and the unit of a cell, `12.3kn`, `183°T`; None for a cell that has none, or a side."""
    match = None if degrees_of(text) is not None else _WITH_UNIT.fullmatch(text.strip().replace(_MINUS_SIGN, "-"))
    if match is None or not (is_unit(match[2]) or match[2].lstrip("° ") in _REFERENCES):
        return None
    return match[1].replace(",", "."), match[2]


def with_units_of_cells(table: RawTable) -> RawTable:
    """Return the table with each unit that all cells of a column have as that of the column, and numbers in its cells.

    A letter for true or magnetic north joins the name: ``Heading`` over ``183T`` becomes ``Heading true`` in degrees.
    """
    names, units, cells = list(table.names), list(table.units_of_columns), list(table.cells)
    for k, column in enumerate(table.cells):
        parsed = _numbers_and_unit(column)
        if parsed is not None:
            cells[k], unit = parsed
            reference = _REFERENCES.get(unit.lstrip("° "), "")
            units[k] = units[k] or ("deg" if reference else unit)
            names[k] = f"{names[k]} {reference}".strip()
    return replace(table, names=tuple(names), units=tuple(units) if any(units) else (), cells=tuple(cells))


def _numbers_and_unit(cells: Sequence | np.ndarray) -> tuple[list[str], str] | None:
    """The cells without the unit that all have that are not empty, and the unit; None where there is no such unit."""
    if isinstance(cells, np.ndarray):
        return None
    numbers, units = list[str](), set[str]()
    for cell in map(str, cells):
        parsed = ("", "") if cell.strip().lower() in EMPTY_CELLS else number_and_unit(cell)
        if parsed is None:
            return None
        numbers.append(parsed[0])
        units |= {parsed[1]} - {""}
        if len(units) > 1:
            return None
    return (numbers, units.pop()) if units else None


# What every reader returns: the topics of a log as tables of cells, before anything is known about them.


@dataclass(frozen=True)
class LogEvent:
    """Something that happened at a time [s on the clock of the log], such as ``MODE MANUAL``."""

    time: float
    name: str


@dataclass(frozen=True)
class Log:
    """The contents of one file.

    Attributes:
        file: file name for messages.
        tables: one for each topic (message, sheet, group); a plain table is the only one and has no topic.
        parameters: settings that the logger stored, such as ``SERVO1_REVERSED``.
        events: in order of time.
        notes: what is to be known of how it was read, and of what it holds that is not read.
    """

    file: str
    tables: tuple[RawTable, ...]
    parameters: Mapping[str, float] = field(default_factory=dict)
    events: tuple[LogEvent, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        if not self.tables:
            raise InputError(f"{self.file} holds no samples; leave it out or replace it")
        object.__setattr__(self, "tables", tuple(map(with_units_of_cells, self.tables)))

    def __reduce__(self) -> tuple[type["Log"], tuple]:
        return type(self), (self.file, self.tables, dict(self.parameters), self.events, self.notes)

    @classmethod
    def of_table(cls, table: RawTable) -> "Log":
        """Return the log that consists of one table."""
        return cls(table.file, (table,))

    @property
    def topics(self) -> tuple[str, ...]:
        """Names of the topics, in the order of the file."""
        return tuple(table.topic for table in self.tables)

    def table_of(self, column: ColumnSpec) -> RawTable:
        """Return the table in which a wanted column stands; `source` is ``topic/field``, or the name in a plain table.

        Raises:
            InputError: there is no such topic; the nearest one is named.
        """
        if len(self.tables) == 1 and (str(column.source).isdecimal() or column.source in self.tables[0].names):
            return self.tables[0]
        for table in self.tables:
            name = str(column.source).removeprefix(f"{table.topic}/")
            if name != column.source and name in table.names:  # a name may hold a stroke itself, as in "ROT [deg/min]"
                return table
        topic = str(column.source).rpartition("/")[0]
        if topic not in self.topics:
            if self.topics == ("",):
                return self.tables[0]
            where = f"topic '{topic}'" if topic else f"topic in '{column.source}', which should read 'topic/field'"
            raise InputError(
                f"{self.file}: channel '{column.symbol}': no {where}{spelling_hint(topic, list(self.topics))}"
            )
        return self.tables[self.topics.index(topic)]


Reader = Callable[[Path, Layout], Log]


def topic_table(
    file: str, topic: str, columns: Mapping[str, Sequence | Array], units: Mapping[str, str] | None = None
) -> RawTable:
    """Return the table of a topic whose column ``time`` holds seconds; units as the file states them."""
    known = {"time": "s", **(units or {})}
    return RawTable(
        file,
        tuple(columns),
        tuple(np.asarray(values) for values in columns.values()),
        topic=topic,
        units=tuple(known.get(name, "") for name in columns),
        time_name="time" if "time" in columns else "",
    )
