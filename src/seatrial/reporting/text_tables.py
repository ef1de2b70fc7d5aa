"""A table of values as text for a page."""

from dataclasses import dataclass

from seatrial.core.results import Table
from seatrial.core.text.numbers import DASH, significant


@dataclass(frozen=True)
class TextTable:
    """A table as text; `numeric`: which columns are right-aligned."""

    title: str
    header: tuple[str, ...]
    numeric: tuple[bool, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str


def text_table(table: Table) -> TextTable:
    """Return the table with its numbers as text."""
    numeric = tuple(
        all(not isinstance(row[k], str) for row in table.rows if k < len(row)) for k in range(len(table.header))
    )
    rows = tuple(tuple(_cell_text(cell, table.digits) for cell in row) for row in table.rows)
    return TextTable(table.title, table.header, numeric, rows, table.note)


def _cell_text(cell: str | float | None, digits: int) -> str:
    if cell is None:
        return DASH
    if isinstance(cell, (str, int)):
        return str(cell)
    return significant(cell, digits)
