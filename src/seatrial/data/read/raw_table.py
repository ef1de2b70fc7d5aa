"""What every reader returns: named columns of cells, before anything is known about them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.data.read.layout import ColumnSpec, Layout

EMPTY_CELLS = ("", "na", "n/a", "null", "none")


@dataclass(frozen=True)
class RawTable:
    """Columns of one file.

    Attributes:
        file: file name for messages.
        names: column names; empty strings where the file has none.
        cells: one sequence for each column, numbers or text, all of the same length.
        first_row: line (or row) number of the first cell.
    """

    file: str
    names: tuple[str, ...]
    cells: tuple[Sequence | np.ndarray, ...]
    first_row: int = 1

    def column_index(self, column: ColumnSpec) -> int:
        """Position of a wanted column.

        Raises:
            InputError: there is no such column; the nearest one is named.
        """
        if isinstance(column.source, int):
            if not 1 <= column.source <= len(self.cells):
                raise InputError(
                    f"{self.file}: channel '{column.symbol}' wants column {column.source}, "
                    f"but the file has {len(self.cells)} columns; columns count from 1"
                )
            return column.source - 1
        if column.source not in self.names:
            known = [name for name in self.names if name]
            hint = spelling_hint(column.source, known) if known else "; the file has no column names, give numbers"
            raise InputError(f"{self.file}: no column '{column.source}' for channel '{column.symbol}'{hint}")
        return self.names.index(column.source)

    def label(self, column: ColumnSpec) -> str:
        """The name kept with the channel: the user's, the file's, or ``column k``."""
        index = self.column_index(column)
        return column.label or self.names[index] or f"column {index + 1}"

    def numbers(self, column: ColumnSpec) -> Array:
        """The cells of a column as numbers, shape (n,); empty cells are NaN.

        Raises:
            InputError: no such column, or a cell that is not a finite number (row and column named).
        """
        cells = self.cells[self.column_index(column)]
        try:
            values = np.asarray(cells, dtype=np.float64)
        except (TypeError, ValueError):
            values = np.array([self._to_number(cell, row, column) for row, cell in enumerate(cells)])
        infinite = np.flatnonzero(np.isinf(values))
        if infinite.size:
            raise InputError(
                f"{self.file}: row {self.first_row + infinite[0]}, {column.display_name}: the number is infinite"
            )
        return values

    def _to_number(self, cell: object, row: int, column: ColumnSpec) -> float:
        if cell is None or (isinstance(cell, str) and cell.strip().lower() in EMPTY_CELLS):
            return np.nan
        try:
            return float(cell)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            raise InputError(
                f"{self.file}: row {self.first_row + row}, {column.display_name}: '{str(cell).strip()}' is "
                "not a number; "
                "check header_lines, separator and decimal"
            ) from None


Reader = Callable[[Path, Layout], RawTable]
