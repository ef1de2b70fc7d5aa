"""One table of a log: named columns of cells, before anything is known about them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.data.read.degrees_minutes import degrees_of
from seatrial.data.read.layout import ColumnSpec

EMPTY_CELLS = ("", "na", "n/a", "null", "none")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?(nan|inf|infinity)|true|false", re.IGNORECASE | re.ASCII)
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

    def column_index(self, column: ColumnSpec) -> int:
        """Position of a wanted column.

        Raises:
            InputError: there is no such column; the nearest one is named.
        """
        if column.symbol == "time" and not column.source:
            return self._time_index()
        if isinstance(column.source, int):
            if not 1 <= column.source <= len(self.cells):
                raise InputError(
                    f"{self.file}: channel '{column.symbol}' wants column {column.source}, "
                    f"but the file has {len(self.cells)} columns; columns count from 1"
                )
            return column.source - 1
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

        Raises:
            InputError: no such column, or a cell that is not a finite number (row and column named).
        """
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
        if _NUMBER.fullmatch(text):
            return float(text[0] in "tT") if text[0] in "tTfF" else float(text)
        angle = degrees_of(text)
        if angle is not None:
            return angle
        where = f"{self.file}: row {self.first_row + row}, {column.display_name}: '{text[:_LONGEST_CELL]}'"
        if _GROUPED_NUMBER.fullmatch(text):
            raise InputError(f"{where} has a thousands separator; write the file without, or set decimal")
        raise InputError(f"{where} is not a number; check header_lines, separator and decimal")
