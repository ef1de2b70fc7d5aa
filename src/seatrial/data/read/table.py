"""The package's own record file: CSV with units in the header, exact both ways."""

import hashlib
import json
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Channel, InputError, Kind, Provenance, Record, frozen, quantity
from seatrial.core.values.files import write_whole
from seatrial.data.read.layout import Column, Layout
from seatrial.data.read.text import TABLE_MARK, decoded, read_text


def write_record(record: Record, path: Path) -> None:
    """Write `record_text` to a file, whole or not at all.

    Raises:
        InputError: the place cannot be written.
    """
    write_whole(path, record_text(record).encode())


def record_text(record: Record) -> str:
    """The record as CSV: a comment line with the metadata, ``time [s],u [m/s],...``, then one line a sample.

    Numbers in shortest exact form, NaN as an empty cell.
    """
    header = ["time [s]", *(f"{symbol} [{channel.unit}]" for symbol, channel in record.channels.items())]
    columns = [record.time, *(channel.values for channel in record.channels.values())]
    rows = (",".join(map(_cell, row)) for row in np.stack(columns, axis=1).tolist())
    return "\n".join([f"{TABLE_MARK} {json.dumps(record.metadata)}", ",".join(header), *rows]) + "\n"


def read_table(path: Path) -> Record:
    """The record of a file written by `write_record`; without its comment line the notation's conventions hold.

    Raises:
        InputError: the file is missing, is not such a table, or holds a cell that is not a number.
    """
    if not path.is_file():
        raise InputError(f"{path} does not exist; check the path")
    text = decoded(path, "utf-8")
    lines = text.splitlines()
    metadata = _parsed(lines[0], path.name) if lines[0].startswith(TABLE_MARK) else {}
    header = [_symbol_unit(cell, path.name) for cell in lines[1 if metadata else 0].split(",")]
    if header[0] != ("time", "s"):
        raise InputError(f"{path.name} is not a record table: its first column must be 'time [s]'")
    layout = Layout("text", Column("time", 1, "s"), (), header_lines=1, separator=",")
    sheet = read_text(path, layout)
    columns = [sheet.numbers(Column("time", number + 1, "s")) for number in range(len(header))]
    described = metadata.get("channels", {})
    channels = {
        symbol: _channel(symbol, unit, values, described.get(symbol, {}))
        for (symbol, unit), values in zip(header[1:], columns[1:], strict=True)
    }
    provenance = Provenance(path.name, hashlib.sha256(path.read_bytes()).hexdigest())
    if metadata:
        provenance = Provenance.of(metadata["provenance"])
    return Record(
        metadata.get("name", path.stem), columns[0], channels, Kind(metadata.get("kind", "measured")), provenance
    )


def _cell(value: float) -> str:
    return "" if value != value else repr(value)


def _parsed(line: str, file: str) -> dict:
    try:
        return json.loads(line.removeprefix(TABLE_MARK))
    except json.JSONDecodeError:
        raise InputError(f"{file}: its first line is damaged; delete it to read the numbers alone") from None


def _symbol_unit(cell: str, file: str) -> tuple[str, str]:
    symbol, bracket, unit = cell.strip().partition(" [")
    if not bracket or not unit.endswith("]"):
        raise InputError(f"{file} is not a record table: column '{cell.strip()}' should read 'symbol [unit]'")
    return symbol, unit[:-1]


def _channel(symbol: str, unit: str, values: Array, described: dict) -> Channel:
    if described:
        return Channel(frozen(values), **{**described, "unit": unit})
    q = quantity(symbol)
    column = Column(symbol, symbol, unit)
    return Channel(frozen(values * column.factor(q.unit)), q.unit, q.frame, q.positive)
