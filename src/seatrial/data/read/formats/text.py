"""Text files: comma, semicolon, tab or whitespace separated, plain or .gz, either decimal sign."""

import codecs
import csv
import gzip
import io
import re
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import EMPTY_CELLS, Log, RawTable, table_header, with_sides

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
_ASCII_COMPATIBLE = ("utf-8", "cp1252", "iso8859-1", "ascii")
# unpacked over packed bytes of a .gz, and bytes that any may unpack to; ours: tables of numbers reach 30
_LARGEST_EXPANSION, _ALWAYS_ALLOWED = 200, 2**26


def utf8_text(path: Path, encoding: str) -> bytes:
    """The text of a file in UTF-8, without a byte order mark; one of UTF-16 overrides the encoding.

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
        if codecs.lookup(encoding).name in _ASCII_COMPATIBLE and data.isascii():
            return data
        text = data.decode(encoding)
        return data if codecs.lookup(encoding).name == "utf-8" else text.encode()
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(
            f"{path.name} is not {encoding} text (byte 0x{data[error.start]:02x} in line {line}); "
            "set encoding, for example to 'cp1252'"
        ) from None
    except (LookupError, ValueError):  # no such codec, or one that is none of text
        raise InputError(f"{path.name}: unknown encoding {encoding!r}; try 'utf-8' or 'cp1252'") from None


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


def detect_separator(sample_line: str, layout: Layout) -> str:
    """The separator of the layout, or the one the line shows."""
    if layout.separator != "auto":
        return _SEPARATORS[layout.separator]
    for candidate in ("\t", ";"):
        if candidate in sample_line.strip(" \r\n"):
            return candidate
    return "," if "," in sample_line and layout.decimal != "," else r"\s+"


def column_names(line: str, separator: str) -> list[str]:
    """The cells of a header line."""
    if separator == r"\s+":
        return [cell.strip().strip('"') for cell in re.split(separator, line.strip())]
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]


def read_text(path: Path, layout: Layout) -> Log:
    """The table of a text file; a leading ``# seatrial record`` line is skipped and not counted.

    Raises:
        InputError: see `utf8_text`; no data lines; a line with too many cells; a quote that does not end in its line.
    """
    head = _plain_head(path, layout)
    data = utf8_text(path, layout.encoding) if head is None else head
    if data[-2:].isspace() and head is None:
        data = data.rstrip()
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    first = int(data.startswith(RECORD_MARK.encode()))
    header_lines = max(layout.header_lines, 1) if layout.has_named_columns else layout.header_lines
    header, sample_line, start = _beginning(data, first + header_lines)
    if sample_line is None:
        lines = data.count(b"\n") + 1
        raise InputError(f"{path.name} has no data lines: {lines} lines, {first + header_lines} of them header")
    separator = detect_separator(sample_line, layout)
    if b'"' in data:
        _refuse_open_quotes(data, start, path.name)
    source = str(path) if head is not None else _after_lines(data, start)
    del data
    has_spaces = f"{separator} " in sample_line
    frame = _data_frame(source, start, separator, layout.decimal, path.name, has_spaces=has_spaces)
    above = [column_names(line, separator) for line in header] if layout.has_named_columns else []
    columns = table_header(above)
    cells = with_sides([_cells(frame.pop(column), layout.decimal) for column in tuple(frame.columns)])
    width = len(cells)
    return Log.of_table(RawTable(path.name, columns.names_of(width), cells, start + 1, "", columns.units_of(width)))


def _plain_head(path: Path, layout: Layout) -> bytes | None:
    """The first lines of a file that pandas can read as it stands, which is faster than bytes; None of another.

    Such a file is packed in nothing, ASCII, without quotes, and does not end with empty lines.
    """
    if path.suffix == ".gz" or layout.encoding.lower() not in _ASCII_COMPATIBLE:
        return None
    with path.open("rb") as file:
        head = chunk = file.read(_HEAD_BYTES)
        end = b""
        while chunk:
            if not chunk.isascii() or b'"' in chunk or b"\0" in chunk:
                return None
            end = (end + chunk[-2:])[-2:]
            chunk = file.read(_CHUNK_BYTES)
    filled = sum(not line.isspace() for line in head.splitlines())
    holds_a_row = filled > layout.header_lines + 2 or len(head) < _HEAD_BYTES  # the mark of a record, a cut line
    return head if holds_a_row and b"\n" in head and not end.isspace() else None


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
    except pd.errors.ParserError as error:
        found = re.search(r"Expected (\d+) fields in line (\d+), saw (\d+)", str(error))
        row = 0 if found is None else int(found[2]) + (0 if isinstance(source, str) else start)
        where = f"row {row} has {found[3]} cells instead of {found[1]}" if found else str(error)
        raise InputError(f"{file}: {where}; check the separator and header_lines") from None


def _exact_numbers(version: str) -> dict:
    """The option that makes pandas read decimal numbers to the last bit, as it does by itself from 3.1 on."""
    major, minor = (int(part) for part in version.split(".")[:2])
    return {} if (major, minor) >= (3, 1) else {"float_precision": "round_trip"}


def _cells(column: "pandas.Series", decimal: str) -> Sequence | np.ndarray:
    """A column as numbers where pandas parsed it, else its text with a decimal point; empty cells are empty text."""
    if column.dtype.kind in "fiub":
        return column.to_numpy()
    if column.dtype == "str" and decimal == ".":
        return cast("Sequence[str]", column.fillna("").array)  # as pandas keeps it: a third of the memory of a list
    text = ["" if cell is None or cell != cell else str(cell) for cell in column.tolist()]
    return text if decimal == "." else [cell.replace(decimal, ".") for cell in text]
