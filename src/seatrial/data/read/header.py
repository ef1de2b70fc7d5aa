"""Names and units of a table's columns, from the rows above its numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.values.units import is_unit

_BRACKETS = "[]() "
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


def table_header(rows: Sequence[Sequence[str]]) -> TableHeader:
    """Return the header from the rows above the numbers: the last one, or the last two where the last holds units.

    Rows without text are passed over. A cell is a unit where it is known as one or stands in brackets.
    """
    filled = [row for row in rows if any(row)][-2:]
    if not filled:
        return TableHeader()
    names, last = filled[0], filled[-1]
    if len(filled) == 2 and len(names) == len(last) and _unit_share(last) >= max(_LEAST_UNITS, _unit_share(names)):
        return TableHeader(tuple(names), tuple(cell.strip(_BRACKETS) for cell in last))
    return TableHeader(tuple(last))


def _unit_share(cells: Sequence[str]) -> float:
    filled = [cell for cell in cells if cell]
    units = [cell.startswith(("[", "(")) or is_unit(cell) for cell in filled]
    return sum(units) / len(units) if units else 0.0
