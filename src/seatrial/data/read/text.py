"""Text files: comma, semicolon, tab or whitespace separated, plain or .gz, either decimal sign."""

import gzip
import io
import re
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.raw_table import RawTable

RECORD_MARK = "# seatrial record"
_SEPARATORS = {",": ",", ";": ";", "tab": "\t", "whitespace": r"\s+"}


def decoded_text(path: Path, encoding: str) -> str:
    """The text of a file.

    Raises:
        InputError: empty, packed wrongly, binary, or not in that encoding.
    """
    data = path.read_bytes()
    if path.suffix == ".gz" and data:
        try:
            data = gzip.decompress(data)
        except (OSError, EOFError) as error:
            raise InputError(f"{path.name} is not a gzip file ({error}); rename or repack it") from None
    if not data.strip():
        raise InputError(f"{path.name} is empty; leave it out or replace it")
    if b"\0" in data[:65536] and not encoding.lower().startswith(("utf-16", "utf_16", "utf-32", "utf_32")):
        raise InputError(f"{path.name} is not a text file (it holds binary data); check the format")
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(
            f"{path.name} is not {encoding} text (byte 0x{data[error.start]:02x} in line {line}); "
            "set encoding, for example to 'cp1252'"
        ) from None
    except LookupError:
        raise InputError(f"{path.name}: unknown encoding '{encoding}'; try 'utf-8' or 'cp1252'") from None


def detect_separator(sample_line: str, layout: Layout) -> str:
    """The separator of the layout, or the one the line shows."""
    if layout.separator != "auto":
        return _SEPARATORS[layout.separator]
    for candidate in ("\t", ";"):
        if candidate in sample_line.strip(" \r\n"):
            return candidate
    return "," if "," in sample_line and layout.decimal != "," else r"\s+"


def _column_names(line: str, column_separator: str) -> list[str]:
    cells = re.split(column_separator, line.strip()) if column_separator == r"\s+" else line.split(column_separator)
    return [cell.strip().strip('"') for cell in cells]


def read_text(path: Path, layout: Layout) -> RawTable:
    """The sheet of a text file; a leading ``# seatrial record`` line is skipped and not counted.

    Raises:
        InputError: see `decoded`; no data lines; a line with too many cells.
    """
    import pandas as pd

    lines = decoded_text(path, layout.encoding).removeprefix("\ufeff").splitlines()
    while lines and not lines[-1].strip():
        lines.pop()
    first = int(bool(lines) and lines[0].startswith(RECORD_MARK))
    start = first + (max(layout.header_lines, 1) if layout.has_named_columns else layout.header_lines)
    if start >= len(lines):
        raise InputError(f"{path.name} has no data lines: {len(lines)} lines, {start} of them header")
    mark = detect_separator(next(line for line in lines[start:] if line.strip()), layout)
    try:
        frame = pd.read_csv(
            io.StringIO("\n".join(lines[start:])),
            sep=mark,
            header=None,
            dtype=object,
            keep_default_na=False,
            skip_blank_lines=False,
        )
    except pd.errors.ParserError as error:
        found = re.search(r"Expected (\d+) fields in line (\d+), saw (\d+)", str(error))
        where = f"row {start + int(found[2])} has {found[3]} cells instead of {found[1]}" if found else str(error)
        raise InputError(f"{path.name}: {where}; check the separator and header_lines") from None
    names = _column_names(lines[start - 1], mark) if layout.has_named_columns else []
    width = frame.shape[1]
    padded = (*names[:width], *[""] * (width - len(names)))
    cells = tuple(_normalised_cells(frame.iloc[:, k].tolist(), layout.decimal) for k in range(width))
    return RawTable(path.name, padded, cells, start + 1)


def _normalised_cells(cells: list, decimal: str) -> list[str]:
    """The cells as text with a decimal point; short rows leave NaN, which counts as empty."""
    text = [cell if isinstance(cell, str) else "" for cell in cells]
    return text if decimal == "." else [cell.replace(decimal, ".") for cell in text]
