"""Excel workbooks (.xlsx), by openpyxl from the extra `logs`."""

import datetime
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, fault_text, require_library, table_header

_LARGEST_EXPANSION = 200  # unpacked over packed bytes; ours: number tables reach 20
_HEADER_ROWS = 20  # rows in which the names of the columns are sought; ours


def read_excel(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every sheet with numbers as a topic; a workbook with one such sheet is a plain table.

    The last row of text before the first row of numbers holds the names; where two follow one another and the second
    is in brackets or known units, it holds the units. Dates and times of day become ISO 8601.

    Raises:
        InputError: openpyxl is not installed, not a workbook, or one that expands beyond sense.
    """
    openpyxl = require_library("openpyxl", path.name, "an Excel workbook", "logs")
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(part.file_size for part in archive.infolist())
        if size > _LARGEST_EXPANSION * path.stat().st_size:
            raise InputError(f"{path.name} unpacks to {size / 1e6:.0f} MB, which no table does; save it again")
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        sheets = [(sheet.title, list(map(_filled, sheet.iter_rows(values_only=True)))) for sheet in book.worksheets]
    except InputError:
        raise
    except Exception as error:  # openpyxl raises zip, key, XML and value errors on damaged workbooks
        raise InputError(
            f"{path.name} is not a readable Excel workbook ({fault_text(error)}); save it again as .xlsx"
        ) from None
    tables = [table for title, rows in sheets if (table := _table(path.name, title, rows)) is not None]
    if len(tables) == 1:
        one = tables[0]
        tables = [RawTable(one.file, one.names, one.cells, one.first_row, "", one.units)]
    if not tables:
        raise InputError(f"{path.name} holds no sheet with rows of numbers; name the columns above them")
    return Log(path.name, tuple(tables))


def _filled(row: tuple) -> tuple:
    """A row up to its last cell that holds anything."""
    return row[: max((k for k, cell in enumerate(row, start=1) if cell is not None), default=0)]


def _table(file: str, title: str, rows: list[tuple]) -> RawTable | None:
    first = next((k for k, row in enumerate(rows[: _HEADER_ROWS + 1]) if any(map(_is_number, row))), None)
    if first is None or len(rows) < first + 2:
        return None
    body = [row for row in rows[first:] if row]
    width = max(map(len, body))
    header = table_header([[_text(cell) for cell in row] + [""] * (width - len(row)) for row in rows[:first]], width)
    columns = {place for row in body for place, cell in enumerate(row) if cell is not None}
    empty = np.broadcast_to(np.nan, len(body))  # takes no memory, however many columns hold nothing
    cells = tuple(
        [_cell(row[k]) if k < len(row) else None for row in body] if k in columns else empty for k in range(width)
    )
    return RawTable(file, header.names_of(width), cells, first + 1, title, header.units_of(width))


def _is_number(cell: Any) -> bool:
    return isinstance(cell, int | float | datetime.datetime | datetime.time) and not isinstance(cell, bool)


def _text(cell: Any) -> str:
    return "" if cell is None else str(cell).strip()


def _cell(cell: Any) -> Any:
    if isinstance(cell, datetime.datetime | datetime.time | datetime.date):
        return cell.isoformat()
    return float(cell) if isinstance(cell, bool) else cell
