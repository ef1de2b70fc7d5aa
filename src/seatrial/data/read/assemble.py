"""From a sheet of cells to a record in SI units, conventions as declared."""

from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Channel, InputError, Provenance, Record, frozen, quantity
from seatrial.core.values.froude import scaled
from seatrial.data.read.layout import Layout
from seatrial.data.read.sheet import Sheet


def assembled(sheet: Sheet, layout: Layout, sha256: str) -> Record:
    """The record of a sheet; empty cells stay NaN, frames and signs stay as declared.

    Raises:
        InputError: time runs backwards, fewer than two samples, a channel without any number, wrong unit.
    """
    time = sheet.numbers(layout.time) * layout.time.factor("s")
    _demand_time(time, sheet, layout)
    columns = []
    for column in layout.columns:
        values = sheet.numbers(column) * column.factor(quantity(column.symbol).unit)
        if np.all(np.isnan(values)):
            raise InputError(
                f"{sheet.file}: {column.place} (channel '{column.symbol}') holds no number at all; leave it out"
            )
        columns.append(values)
    labels = tuple(sheet.label(column) for column in layout.columns)
    provenance = Provenance(sheet.file, sha256, (f"read as {layout.format}",))
    return as_declared(stem(sheet.file), layout, time, np.stack(columns, axis=1), labels, provenance)


def as_declared(
    name: str,
    layout: Layout,
    time: Array,
    values: Array,
    labels: tuple[str, ...] = (),
    provenance: Provenance | None = None,
) -> Record:
    """The record of rows that are numbers already: time (n,) [s], the layout's columns (n, k) [SI], as declared."""
    named = labels or tuple(column.label or column.place for column in layout.columns)
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
    return scaled(Record(name, time, channels, provenance=provenance or Provenance(name)), layout.scale)


def stem(file: str) -> str:
    """The record's name: the file name without its suffixes."""
    path = Path(file.removesuffix(".gz"))
    return path.stem if path.suffix else path.name


def _demand_time(time: Array, sheet: Sheet, layout: Layout) -> None:
    known = np.flatnonzero(np.isfinite(time))
    if known.size < 2:
        count = "no time stamp" if known.size == 0 else "one sample"
        raise InputError(f"{sheet.file} has {count} in {layout.time.place}; a record needs at least two")
    back = np.flatnonzero(np.diff(time[known]) < 0)
    if back.size:
        row = known[back[0] + 1]
        raise InputError(
            f"{sheet.file}: row {sheet.first_row + row}: time runs backwards from {time[known[back[0]]]:g} s "
            f"to {time[row]:g} s; sort or split the file"
        )
