"""How a text file is laid out, from its first lines: header, separator, decimal sign, encoding."""

import re
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.read.formats.text import column_names, decoded_text, detect_separator
from seatrial.data.read.header import table_header

# lines in which the first row of numbers is sought, ours: the longest header of a towing tank's files has forty
_HEADER_LINES = 60
_SECOND_ENCODING = "cp1252"  # of programs on Windows that write no mark
_CELL = re.compile(
    r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?|nan|inf|true|false|\d{4}[-/]\d\d?[-/]\d\d?([T ].*)?|\d\d?:\d\d:\d\d.*|",
    re.IGNORECASE,
)
_DECIMAL_COMMA = re.compile(r"[+-]?\d+(,\d+)?")
_WHITESPACE = r"\s+"
_HEAD_BYTES, _ZERO_SHARE = 2048, 0.9  # bytes looked at for lost marks of UTF-16, share of zeros in its high bytes; ours
_NUMBER_SHARE = 0.5  # of the cells of a row of data that must be numbers or times; ours


def text_layout(path: Path) -> Layout:
    """Return the layout of a text file without channels: what stands above the first two rows of numbers is header.

    Raises:
        InputError: no rows of numbers in its first lines; empty or binary.
    """
    encoding, text = _decoded(path)
    lines = text.splitlines()[: _HEADER_LINES + 2]
    for first in range(max(len(lines) - 1, 0)):
        separator = _separator(lines[first])
        rows = [_cells(line, separator) for line in lines[first : first + 2]]
        if len(rows[0]) == len(rows[1]) and all(_is_data(row) for row in rows):
            return _layout(lines, first, separator, encoding)
    raise InputError(f"{path.name} has no rows of numbers in its first {len(lines)} lines; check what it is")


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
        head = file.read(_HEAD_BYTES)
    zeros = {head[0::2].count(0): "utf-16-be", head[1::2].count(0): "utf-16-le"}
    most = max(zeros)
    return zeros[most] if most > _ZERO_SHARE * (len(head) // 2) and len(zeros) > 1 and min(zeros) == 0 else ""


def _separator(line: str) -> str:
    """`;` or tab where the line has one, else comma unless that is the decimal sign, else whitespace."""
    separator = detect_separator(line, Layout("text", ColumnSpec("time", 1, "s"), ()))
    cells = line.split()
    if separator == "," and len(cells) > 1 and all(_DECIMAL_COMMA.fullmatch(cell) for cell in cells):
        return _WHITESPACE
    return separator


def _cells(line: str, separator: str) -> list[str]:
    return column_names(line, separator) if line.strip() else []


def _is_data(row: list[str]) -> bool:
    """Whether a row has a number, and numbers or times in most cells."""
    filled = [cell for cell in row if cell]
    known = sum(_CELL.fullmatch(cell) is not None for cell in filled)
    return bool(filled) and known >= _NUMBER_SHARE * len(filled) and any(cell[0] in "+-.0123456789" for cell in filled)


def _layout(lines: list[str], first: int, separator: str, encoding: str) -> Layout:
    row = _cells(lines[first], separator)
    decimal = "," if separator != "," and any("," in cell and _DECIMAL_COMMA.fullmatch(cell) for cell in row) else "."
    while first and not lines[first - 1].strip():  # the reader passes over empty lines between header and data
        first -= 1
    header = table_header([_cells(line, separator) for line in lines[:first]]).names
    named = len(header) == len(row) and any(cell and not _CELL.fullmatch(cell) for cell in header)
    source: str | int = next(cell for cell in header if cell) if named else 1
    return Layout("text", ColumnSpec("time", source, "s"), (), first, encoding, decimal=decimal)
