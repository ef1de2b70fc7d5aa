"""From a sheet of cells to a record in SI units, conventions as declared."""

from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Channel, InputError, Provenance, Record, frozen, quantity
from seatrial.core.values.froude import froude_scaled
from seatrial.data.read.layout import Layout
from seatrial.data.read.raw_table import RawTable


def assemble_record(table: RawTable, layout: Layout, sha256: str) -> Record:
    """The record of a sheet; empty cells stay NaN, frames and signs stay as declared.

    Raises:
        InputError: time runs backwards, fewer than two samples, a channel without any number, wrong unit.
    """
    time = table.numbers(layout.time) * layout.time.si_factor("s")
    _require_increasing_time(time, table, layout)
    columns = []
    for column in layout.columns:
        values = table.numbers(column) * column.si_factor(quantity(column.symbol).unit)
        if np.all(np.isnan(values)):
            raise InputError(
                f"{table.file}: {column.display_name} (channel '{column.symbol}') holds no number at all; leave it out"
            )
        columns.append(values)
    labels = tuple(table.label(column) for column in layout.columns)
    provenance = Provenance(table.file, sha256, (f"read as {layout.format}",))
    return record_from_values(record_name(table.file), layout, time, np.stack(columns, axis=1), labels, provenance)


def record_from_values(
    name: str,
    layout: Layout,
    time: Array,
    values: Array,
    labels: tuple[str, ...] = (),
    provenance: Provenance | None = None,
) -> Record:
    """The record of rows that are numbers already: time (n,) [s], the layout's columns (n, k) [SI], as declared."""
    named = labels or tuple(column.label or column.display_name for column in layout.columns)
    channels = {
        column.symbol: Channel(
            frozen(values[:, k]),
            quantity(column.symbol).unit,
            column.declared_frame,
            column.declared_positive,
            column.reference_point,
            named[k],
        )
        for k, column in enumerate(layout.columns)
    }
    return froude_scaled(Record(name, time, channels, provenance=provenance or Provenance(name)), layout.scale)


def record_name(file: str) -> str:
    """The record's name: the file name without its suffixes."""
    path = Path(file.removesuffix(".gz"))
    return path.stem if path.suffix else path.name


def _require_increasing_time(time: Array, table: RawTable, layout: Layout) -> None:
    stamped = np.flatnonzero(np.isfinite(time))
    if stamped.size < 2:
        count = "no time stamp" if stamped.size == 0 else "one sample"
        raise InputError(f"{table.file} has {count} in {layout.time.display_name}; a record needs at least two")
    back = np.flatnonzero(np.diff(time[stamped]) < 0)
    if back.size:
        row = stamped[back[0] + 1]
        raise InputError(
            f"{table.file}: row {table.first_row + row}: time runs backwards from {time[stamped[back[0]]]:g} s "
            f"to {time[row]:g} s; sort or split the file"
        )
