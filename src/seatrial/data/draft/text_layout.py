"""How a text file is laid out, from its first lines: header, separator, decimal sign, encoding."""

import re
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.read.formats.text import column_names, decoded_text, detect_separator

# lines in which the first row of numbers is sought, ours: the longest header of a towing tank's files has forty
_HEADER_LINES = 60
_SECOND_ENCODING = "cp1252"  # of programs on Windows that write no mark
_CELL = re.compile(
    r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?|nan|inf|true|false|\d{4}[-/]\d\d?[-/]\d\d?([T ].*)?|\d\d?:\d\d:\d\d.*|",
    re.IGNORECASE,
)
_NUMBER_SHARE = 0.5  # of the cells of a row of data that must be numbers or times; ours


def text_layout(path: Path) -> Layout:
    """Return the layout of a text file without channels: what stands above the first two rows of numbers is header.

    Raises:
        InputError: no rows of numbers in its first lines; empty or binary.
    """
    encoding = "utf-8"
    try:
        text = decoded_text(path, encoding)
    except InputError as error:
        if "is not utf-8 text" not in str(error):
            raise
        encoding = _SECOND_ENCODING
        text = decoded_text(path, encoding)
    lines = text.splitlines()[: _HEADER_LINES + 2]
    for first in range(max(len(lines) - 1, 0)):
        separator = _separator(lines[first])
        rows = [_cells(line, separator) for line in lines[first : first + 2]]
        if len(rows[0]) == len(rows[1]) and all(_is_data(row) for row in rows):
            return _layout(lines, first, separator, encoding)
    raise InputError(f"{path.name} has no rows of numbers in its first {len(lines)} lines; check what it is")


def _separator(line: str) -> str:
    """`;` or tab where the line has one, else comma, else whitespace."""
    return detect_separator(line, Layout("text", ColumnSpec("time", 1, "s"), ()))


def _cells(line: str, separator: str) -> list[str]:
    return column_names(line, separator) if line.strip() else []


def _is_data(row: list[str]) -> bool:
    """Whether a row has a number, and numbers or times in most cells."""
    filled = [cell for cell in row if cell]
    known = sum(_CELL.fullmatch(cell) is not None for cell in filled)
    return bool(filled) and known >= _NUMBER_SHARE * len(filled) and any(cell[0] in "+-.0123456789" for cell in filled)


def _layout(lines: list[str], first: int, separator: str, encoding: str) -> Layout:
    row = _cells(lines[first], separator)
    decimal = "," if separator == ";" and any(re.fullmatch(r"-?\d+,\d+", cell) for cell in row) else "."
    header = _cells(lines[first - 1], separator) if first else []
    named = len(header) == len(row) and any(cell and not _CELL.fullmatch(cell) for cell in header)
    source: str | int = next(cell for cell in header if cell) if named else 1
    return Layout("text", ColumnSpec("time", source, "s"), (), first, encoding, decimal=decimal)
