"""Text files: comma, semicolon, tab or whitespace separated, plain or .gz, either decimal sign."""

import codecs
import csv
import gzip
import io
import re
import warnings
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import ColumnSpec, Layout, Separator
from seatrial.data.read.log import (
    EMPTY_CELLS,
    Log,
    RawTable,
    degrees_of,
    number_and_unit,
    table_header,
    with_sides,
)

if TYPE_CHECKING:
    import pandas

RECORD_MARK = "# seatrial record"
_HEAD_BYTES = 65536  # of a file that are looked at for zero bytes; chosen
_CHUNK_BYTES = 2**20  # of a file that are looked at together: they stay in the processor's cache; chosen
_SEPARATORS = {",": ",", ";": ";", "tab": "\t", "whitespace": r"\s+"}
_BYTE_ORDER_MARKS = {
    b"\xff\xfe\0\0": "utf-32",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
    b"\xef\xbb\xbf": "utf-8-sig",
}
_LINE_SHOWN = 20  # characters of a line that a message quotes; ours
# what columns of a table with a reading in each row are called; share of its rows that names of quantities are at most,
# ours: a name comes again and again
_QUANTITY_NAMES = (
    "path", "name", "key", "channel", "signal", "parameter", "sensor", "quantity", "variable", "field", "topic",
)  # fmt: skip
_VALUE_NAMES, _SHARE_OF_NAMES = ("value", "val", "reading", "data"), 0.5
_ASCII_COMPATIBLE = ("utf-8", "cp1252", "iso8859-1", "ascii")
# bytes of a file that NumPy reads by itself, ours: it takes as long for them as importing pandas; whole numbers from
# which on floats leave some out; a whole number with a minus that it does not need, which whole columns drop
_SMALL_BYTES, _LARGEST_WHOLE, _MINUS_ZERO = 2**22, 2.0**53, re.compile(r"-0+(?![.\deE])")
# unpacked over packed bytes of a .gz, and bytes that any may unpack to; ours: tables of numbers reach 30
_LARGEST_EXPANSION, _ALWAYS_ALLOWED = 200, 2**26


def utf8_text(path: Path, encoding: str) -> bytes:
    """The text of a file in UTF-8, without a byte order mark; one of UTF-16 overrides the encoding.

    Lines end with a line feed, whichever way the file ends them.

    Raises:
        InputError: empty, packed wrongly or without end, binary, or not in that encoding.
    """
    data = _unpacked(path) if path.suffix == ".gz" else _plain_bytes(path, encoding)
    if not data[:_HEAD_BYTES].strip() and not data.strip():
        raise InputError(f"{path.name} is empty; leave it out or replace it")
    mark = next((mark for mark in _BYTE_ORDER_MARKS if data.startswith(mark)), b"")
    encoding = _BYTE_ORDER_MARKS.get(mark, encoding)
    if b"\0" in data[:_HEAD_BYTES] and not _may_hold_zeros(encoding):
        raise _binary_error(path)
    try:
        if not (codecs.lookup(encoding).name in _ASCII_COMPATIBLE and data.isascii()):
            text = data.decode(encoding)
            data = data if codecs.lookup(encoding).name == "utf-8" else text.encode()
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(
            f"{path.name} is not {encoding} text (byte 0x{data[error.start]:02x} in line {line}); "
            "set encoding, for example to 'cp1252'"
        ) from None
    except (LookupError, ValueError):  # no such codec, or one that is none of text
        raise InputError(f"{path.name}: unknown encoding {encoding!r}; try 'utf-8' or 'cp1252'") from None
    for ending in (b"\r\r\n", b"\r\n", b"\r") if b"\r" in data else ():
        data = data.replace(ending, b"\n")
    return data


def _plain_bytes(path: Path, encoding: str) -> bytes:
    """The bytes of a file that is not packed; no more is read than up to the first zero byte, which text has none of.

    Raises:
        InputError: it holds a zero byte.
    """
    chunks = []
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK_BYTES):
            if not chunks and chunk[:2] in _BYTE_ORDER_MARKS:
                encoding = _BYTE_ORDER_MARKS[chunk[:2]]
            if b"\0" in chunk and not _may_hold_zeros(encoding):
                raise _binary_error(path)
            chunks.append(chunk)
    return b"".join(chunks)


def _may_hold_zeros(encoding: str) -> bool:
    return encoding.lower().replace("_", "-").startswith(("utf-16", "utf-32"))


def _binary_error(path: Path) -> InputError:
    return InputError(f"{path.name} is not a text file (it holds binary data); check the format")


def decoded_text(path: Path, encoding: str) -> str:
    """The text of a file; errors as `utf8_text`."""
    return utf8_text(path, encoding).decode()


def _unpacked(path: Path) -> bytes:
    size = path.stat().st_size
    limit = max(_ALWAYS_ALLOWED, _LARGEST_EXPANSION * size)
    data = bytearray()
    try:
        with gzip.open(path) as file:
            while len(data) <= limit and (chunk := file.read(_CHUNK_BYTES)):
                data += chunk
    except (OSError, EOFError, gzip.zlib.error) as error:  # type: ignore[attr-defined]
        if size == 0:
            return b""
        raise InputError(f"{path.name} is not a gzip file ({error}); rename or repack it") from None
    if len(data) > limit:
        raise InputError(f"{path.name} unpacks to more than {limit / 1e6:.0f} MB, which no table does; repack it")
    return bytes(data)


# How a text file is laid out, from its first lines: header, separator, decimal sign, encoding.

# lines in which the first row of numbers is sought, and that are looked at in all, ours: the longest header of a towing
# tank's files has forty; cells of them that are looked at, ours: of a wide table some rows say as much
_HEADER_LINES, _LINES, _CELLS = 60, 200, 20_000
_SECOND_ENCODING = "cp1252"  # of programs on Windows that write no mark
_CELL = re.compile(
    r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?|nan|inf|true|false|"
    r"\d{1,4}[-/.]\d\d?[-/.]\d{1,4}([T ].*)?|\d\d?:\d\d:\d\d.*|",
    re.IGNORECASE,
)
_DECIMAL_COMMA = re.compile(r"[+-]?\d+(,\d+)?")
_DECIMAL_POINT = re.compile(r"[+-]?\d*\.\d+")
_WHITESPACE = r"\s+"
_MARK_BYTES, _ZERO_SHARE = 2048, 0.9  # bytes looked at for lost marks of UTF-16, share of zeros in its high bytes; ours
_NUMBER_SHARE = 0.5  # of the cells of a row of data that must be numbers or times; ours


@dataclass(frozen=True)
class _Line:
    """A line of a text file: its cells, and which of them are numbers or times; empty cells count as such."""

    separator: str
    cells: list[str]

    @property
    def shape(self) -> tuple[str, int]:
        return self.separator, len(self.cells)

    @cached_property
    def numbers(self) -> list[bool]:
        return [
            _CELL.fullmatch(cell) is not None or degrees_of(cell) is not None or number_and_unit(cell) is not None
            for cell in self.cells
        ]

    @cached_property
    def is_data(self) -> bool:
        """Whether it has a number, and numbers or times in most cells."""
        filled = [(cell, number) for cell, number in zip(self.cells, self.numbers, strict=True) if cell]
        return sum(number for _, number in filled) >= _NUMBER_SHARE * len(filled) and any(
            cell[0] in "+-.0123456789" for cell, _ in filled
        )


def text_layout(path: Path) -> Layout:
    """Return the layout of a text file without channels: what stands above its table is header.

    The table is what most lines of numbers share: separator, number of cells, and which of these are numbers.

    Raises:
        InputError: no rows of numbers in its first lines; empty or binary.
    """
    head = _ascii_head(path)
    if head is not None and len(head) == _HEAD_BYTES:  # its last line is cut
        head = head[: head.rfind(b"\n")] if head.count(b"\n") > _HEADER_LINES else None
    encoding, text = _decoded(path) if head is None else ("utf-8", head.decode())
    lines, count = list[_Line](), 0
    for line in text.split("\n", _LINES)[:_LINES]:
        lines.append(_line(line.rstrip("\r"), path.name))
        count += len(lines[-1].cells)
        if count > _CELLS and len(lines) > 2:
            break
    rows = [line for line in lines if line.is_data]
    shape = max(Counter(row.shape for row in rows).items(), key=lambda each: each[1], default=(None, 0))[0]
    rows = [row for row in rows if row.shape == shape]
    usual = np.mean([row.numbers for row in rows], axis=0) > _NUMBER_SHARE if rows else np.empty(0, dtype=bool)
    is_row = [line.shape == shape and line.is_data and np.all(np.array(line.numbers)[usual]) for line in lines]
    first = next((k for k in range(min(len(lines) - 1, _HEADER_LINES)) if is_row[k] and is_row[k + 1]), None)
    if first is None:
        raise InputError(f"{path.name} has no rows of numbers in its first {len(lines)} lines; check what it is")
    return _layout(lines, first, encoding)


def _decoded(path: Path) -> tuple[str, str]:
    """The encoding of a file and its text: UTF-8, else that of Windows, or UTF-16 of which the mark was lost."""
    try:
        return "utf-8", decoded_text(path, "utf-8")
    except InputError as error:
        encoding = _unmarked_encoding(path) if "binary" in str(error) else ""
        encoding = _SECOND_ENCODING if "is not utf-8 text" in str(error) else encoding
        if not encoding:
            raise
    return encoding, decoded_text(path, encoding)


def _unmarked_encoding(path: Path) -> str:
    """UTF-16 in the order in which every second byte of the file's beginning is zero; empty for other files."""
    with path.open("rb") as file:
        head = file.read(_MARK_BYTES)
    zeros = {head[0::2].count(0): "utf-16-be", head[1::2].count(0): "utf-16-le"}
    most = max(zeros)
    return zeros[most] if most > _ZERO_SHARE * (len(head) // 2) and len(zeros) > 1 and min(zeros) == 0 else ""


def _line(text: str, file: str) -> _Line:
    """The cells by `;` or tab where the line has one, else by comma unless that is the decimal sign, else by spaces."""
    separator = detect_separator(text, "auto")
    return _Line(separator, column_names(text, separator, file) if text.strip() else [])


def _layout(lines: list[_Line], first: int, encoding: str) -> Layout:
    row = lines[first].cells
    while first and not lines[first - 1].cells:  # the reader passes over empty lines between header and data
        first -= 1
    header = table_header([line.cells for line in lines[:first]], len(row)).names
    filled = len(row) - next((k for k, cell in enumerate(reversed(row)) if cell), 0)
    named = filled <= len(header) <= len(row) and any(cell and not _CELL.fullmatch(cell) for cell in header)
    source: str | int = next(cell for cell in header if cell) if named else 1
    return Layout("text", ColumnSpec("time", source, "s"), (), first, encoding)


# The table of a text file.


def detect_separator(sample_line: str, separator: Separator) -> str:
    """The separator, or the one the line shows."""
    if separator != "auto":
        return _SEPARATORS[separator]
    for candidate in ("\t", ";"):
        if candidate in sample_line.strip(" \r\n"):
            return candidate
    cells = sample_line.split()
    are_decimal = len(cells) > 1 and all(_DECIMAL_COMMA.fullmatch(cell) for cell in cells)
    return "," if "," in sample_line and not are_decimal else _WHITESPACE


def _decimal_sign(lines: Iterable[str], separator: str, file: str) -> str:
    """The decimal sign of lines of data: a comma where some cell is a number with one, and none with a point."""
    if separator == ",":
        return "."
    cells = [cell for line in lines for cell in column_names(line, separator, file)]
    has_points = any(_DECIMAL_POINT.fullmatch(cell) for cell in cells)
    return "," if not has_points and any("," in cell and _DECIMAL_COMMA.fullmatch(cell) for cell in cells) else "."


def column_names(line: str, separator: str, file: str) -> list[str]:
    """The cells of a line of a file.

    Raises:
        InputError: one is longer than any logger writes.
    """
    if separator == r"\s+":
        return [cell.strip().strip('"') for cell in re.split(separator, line.strip())]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]
    except csv.Error:
        raise InputError(
            f"{file}: a cell of the line '{line[:_LINE_SHOWN]}...' has over {csv.field_size_limit():,} characters; "
            "remove the line"
        ) from None


def read_text(path: Path, layout: Layout) -> Log:
    """The table of a text file; a leading ``# seatrial record`` line is skipped and not counted.

    Raises:
        InputError: see `utf8_text`; no data lines; a line with too many cells; a quote that does not end in its line.
    """
    head = _ascii_head(path) if layout.encoding.lower() in _ASCII_COMPATIBLE else None
    if head is not None and not _holds_a_row(head, layout):
        head = None
    data = utf8_text(path, layout.encoding) if head is None else head
    if data[-2:].isspace() and head is None:
        data = data.rstrip()
    first = int(data.startswith(RECORD_MARK.encode()))
    header_lines = max(layout.header_lines, 1) if layout.has_named_columns else layout.header_lines
    header, sample_line, start = _beginning(data, first + header_lines)
    if sample_line is None:
        lines = data.count(b"\n") + 1
        raise InputError(f"{path.name} has no data lines: {lines} lines, {first + header_lines} of them header")
    separator = detect_separator(sample_line, layout.separator)
    lines = data[:_HEAD_BYTES].decode(errors="replace").splitlines()[start : start + _LINES]
    decimal = _decimal_sign([sample_line, *lines], separator, path.name)
    if b'"' in data:
        _refuse_open_quotes(data, start, path.name)
    columns = None
    if path.stat().st_size <= _SMALL_BYTES:
        columns = _plain_numbers(data if head is None else path.read_bytes(), start, separator)
    if columns is None:
        source = str(path) if head is not None else _after_lines(data, start)
        del data
        has_spaces = f"{separator} " in sample_line
        frame = _data_frame(source, start, separator, decimal, path.name, has_spaces=has_spaces)
        columns = [_column_cells(frame[column], decimal) for column in frame.columns]
    above = [column_names(line, separator, path.name) for line in header] if layout.has_named_columns else []
    cells = with_sides(columns)
    width = len(cells)
    names = table_header(above, width)
    table = RawTable(path.name, names.names_of(width), cells, start + 1, "", names.units_of(width))
    return Log(path.name, _topics_of(table) or (table,))


def _topics_of(table: RawTable) -> tuple[RawTable, ...]:
    """A topic for each quantity of a table with a reading in each row: its name in one column, its value in another.

    Empty for a table with a column for each quantity. The last part of the name is that of the topic's column.
    """
    plain = [name.strip().lower() for name in table.names]
    places = [k for k, name in enumerate(plain) if name in _QUANTITY_NAMES]
    value = next((k for k, name in enumerate(plain) if name in _VALUE_NAMES), None)
    if len(places) != 1 or value is None or isinstance(table.cells[places[0]], np.ndarray):
        return ()
    rows: dict[str, list[int]] = {}
    for row, cell in enumerate(table.cells[places[0]]):
        rows.setdefault(str(cell), []).append(row)
    if not 0 < len(rows) <= _SHARE_OF_NAMES * len(table):
        return ()
    kept = [k for k in range(len(plain)) if k != places[0]]
    return tuple(
        RawTable(
            table.file,
            tuple(re.split(r"[./]", topic)[-1] if k == value else table.names[k] for k in kept),
            tuple(np.asarray(table.cells[k])[chosen] for k in kept),
            table.first_row + chosen[0],
            topic,
        )
        for topic, chosen in rows.items()
        if topic
    )


def _ascii_head(path: Path) -> bytes | None:
    """The first lines of a file that pandas can read as it stands, which is faster than bytes; None of another.

    Such a file is packed in nothing, ASCII, without quotes and lone carriage returns, and does not end with empty
    lines.
    """
    if path.suffix == ".gz":
        return None
    with path.open("rb") as file:
        head = chunk = file.read(_HEAD_BYTES)
        end, returns = b"", 0
        while chunk:
            if not chunk.isascii() or b'"' in chunk or b"\0" in chunk:
                return None
            returns += chunk.count(b"\r") - (end[-1:] + chunk).count(b"\r\n")
            end = (end + chunk[-2:])[-2:]
            chunk = file.read(_CHUNK_BYTES)
    return head if b"\n" in head and not returns and not end.isspace() else None


def _holds_a_row(head: bytes, layout: Layout) -> bool:
    """Whether the beginning of a file reaches into its data: beyond the mark of a record, and a line that is cut."""
    return len(head) < _HEAD_BYTES or sum(map(bool, map(bytes.strip, head.splitlines()))) > layout.header_lines + 2


class _Beginning(NamedTuple):
    """The header lines, the first line of data (None without any), and how many lines stand before that one."""

    header: list[str]
    sample_line: str | None
    start: int


def _beginning(data: bytes, header_lines: int) -> _Beginning:
    """What stands before the data; empty lines after the header belong to it."""
    lines = enumerate(line.decode() for line in io.BytesIO(data))
    header = [line.rstrip("\r\n") for _, (_, line) in zip(range(header_lines), lines, strict=False)]
    start, sample_line = next(((number, line) for number, line in lines if line.strip()), (header_lines, None))
    return _Beginning(header, sample_line, start)


def _after_lines(data: bytes, count: int) -> io.BytesIO:
    """The text after so many lines: pandas would take a quote in a line that it skips for the beginning of a cell."""
    text = io.BytesIO(data)
    for _ in range(count):
        text.readline()
    return text


def _refuse_open_quotes(data: bytes, start: int, file: str) -> None:
    for number, line in enumerate(data.splitlines()[start:], start=start + 1):
        if line.count(b'"') % 2:
            raise InputError(
                f"{file}: row {number} has a quote that is opened and not closed, which would swallow the rows after "
                "it; remove the quote"
            )


def _plain_numbers(data: bytes, start: int, separator: str) -> list[np.ndarray] | None:
    """The columns of a small table with a plain number in every cell, as pandas has them; None of another table.

    Importing pandas takes longer than all else that is done with such a file.
    """
    rows = [row.decode("ascii", errors="replace") for row in data.splitlines()[start:]]
    delimiter = None if separator == _WHITESPACE else separator
    blank = " \t" if delimiter is None else delimiter
    if set().union(*rows) - {*"0123456789.eE+-", *blank} or any(map(_MINUS_ZERO.search, rows)):
        return None
    try:
        table = np.loadtxt(rows, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:  # a row of another number of cells, or a cell that is no number
        return None
    if len(table) < len(rows) or not np.all(np.abs(table) < _LARGEST_WHOLE):
        return None
    is_whole = np.all(table == np.round(table), axis=0)
    for k in np.flatnonzero(is_whole).tolist():
        is_whole[k] = not set().union(*(row.split(delimiter)[k] for row in rows)) & {*".eE"}
    return [table[:, k].astype(np.int64) if is_whole[k] else table[:, k].copy() for k in range(table.shape[1])]


def _data_frame(
    source: str | io.BytesIO, start: int, separator: str, decimal: str, file: str, *, has_spaces: bool
) -> "pandas.DataFrame":
    import pandas as pd

    try:
        with warnings.catch_warnings():
            # of columns that are numbers in one part of the file and text in another; their cells are read one by one
            warnings.simplefilter("ignore", pd.errors.DtypeWarning)
            return pd.read_csv(
                source,
                sep=separator,
                header=None,
                skiprows=start if isinstance(source, str) else 0,
                decimal=decimal,
                keep_default_na=False,
                na_values=list(EMPTY_CELLS),
                skip_blank_lines=False,
                skipinitialspace=has_spaces,
                **_exact_numbers(pd.__version__),
            )
    except pd.errors.EmptyDataError:
        raise InputError(f"{file} has no data lines after line {start}; check header_lines") from None
    except pd.errors.ParserError as error:
        found = re.search(r"Expected (\d+) fields in line (\d+), saw (\d+)", str(error))
        row = 0 if found is None else int(found[2]) + (0 if isinstance(source, str) else start)
        where = f"row {row} has {found[3]} cells instead of {found[1]}" if found else str(error)
        raise InputError(f"{file}: {where}; check the separator and header_lines") from None


def _exact_numbers(version: str) -> dict:
    """The option that makes pandas read decimal numbers to the last bit, as it does by itself from 3.1 on."""
    major, minor = (int(part) for part in version.split(".")[:2])
    return {} if (major, minor) >= (3, 1) else {"float_precision": "round_trip"}


def _column_cells(column: "pandas.Series", decimal: str) -> Sequence | np.ndarray:
    """A column as numbers where pandas parsed it, else its text with a decimal point; empty cells are empty text."""
    if column.dtype.kind in "fiub":
        return column.to_numpy()
    if column.dtype == "str" and decimal == ".":
        return cast("Sequence[str]", column.fillna("").array)  # as pandas keeps it: a third of the memory of a list
    text = ["" if cell is None or cell != cell else str(cell) for cell in column.tolist()]
    return text if decimal == "." else [cell.replace(decimal, ".") for cell in text]
