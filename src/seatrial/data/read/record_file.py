"""One record file of any format; the package's own is CSV with units in the header, exact both ways."""

import hashlib
import json
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Channel, InputError, Provenance, Record, RecordKind, frozen, quantity
from seatrial.core.values.files import is_file, is_folder, is_present, parse_json, plain_name, write_atomically
from seatrial.data.read.assemble import assemble_record
from seatrial.data.read.formats.text import RECORD_MARK, decoded_text, read_text
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.log import Log
from seatrial.data.read.registry import reader_of
from seatrial.numerics.platform import written_size

# The package's own record file: CSV with units in the header, exact both ways.


def write_record_csv(record: Record, path: Path) -> None:
    """Write `record_text` to a file, whole or not at all.

    Raises:
        InputError: the place cannot be written.
    """
    write_atomically(path, record_csv(record).encode())


def record_csv(record: Record) -> str:
    """The record as CSV: a comment line with the metadata, ``time [s],u [m/s],...``, then one line a sample.

    Numbers in shortest exact form; what is NaN or was not measured as an empty cell.
    """
    header = ["time [s]", *(f"{symbol} [{channel.unit}]" for symbol, channel in record.channels.items())]
    columns = [record.time, *(channel.measured for channel in record.channels.values())]
    rows = (",".join(map(_cell_text, row)) for row in np.stack(columns, axis=1).tolist())
    return "\n".join([f"{RECORD_MARK} {json.dumps(record.metadata)}", ",".join(header), *rows]) + "\n"


def read_record_csv(path: Path) -> Record:
    """The record of a file written by `write_record`; without its comment line the notation's conventions hold.

    Raises:
        InputError: the file is missing, is not such a table, or holds a cell that is not a number.
    """
    if not is_file(path):
        raise InputError(f"{path} does not exist; check the path")
    text = decoded_text(path, "utf-8")
    lines = text.splitlines()
    marked = bool(lines) and lines[0].startswith(RECORD_MARK)
    if len(lines) < 2 + marked:
        raise InputError(f"{path.name} holds no samples; a record file has a line 'time [s],…' and one line a sample")
    header = [_split_heading(cell, path.name) for cell in lines[marked].split(",")]
    if header[0] != ("time", "s"):
        raise InputError(f"{path.name} is not a record table: its first column must be 'time [s]'")
    layout = Layout("text", ColumnSpec("time", 1, "s"), (), header_lines=1, separator=",")
    sheet = read_text(path, layout).tables[0]
    time, *columns = [sheet.numbers(ColumnSpec("time", number + 1, "s")) for number in range(len(header))]
    if not marked:
        plain = {s: _plain_channel(s, unit, values) for (s, unit), values in zip(header[1:], columns, strict=True)}
        source = Provenance(plain_name(path.name), hashlib.sha256(path.read_bytes()).hexdigest())
        return Record(plain_name(path.stem), time, plain, provenance=source)
    try:
        metadata = parse_json(lines[0].removeprefix(RECORD_MARK))
        described = metadata["channels"]
        channels = {
            symbol: Channel(frozen(values), **{**described[symbol], "unit": unit})
            for (symbol, unit), values in zip(header[1:], columns, strict=True)
        }
        provenance = Provenance.from_metadata(metadata["provenance"])
        return Record(metadata["name"], time, channels, RecordKind(metadata["kind"]), provenance)
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path.name}: its first line is damaged; delete it to read the numbers alone") from None


def _cell_text(value: float) -> str:
    return "" if value != value else repr(value)


def _split_heading(cell: str, file: str) -> tuple[str, str]:
    symbol, bracket, unit = cell.strip().partition(" [")
    if not bracket or not unit.endswith("]"):
        raise InputError(
            f"{file} is not a record table: column '{cell.strip()}' should read 'symbol [unit]', as in "
            "time [s], delta [rad], command_1 [1]"
        )
    return symbol, unit[:-1]


def _plain_channel(symbol: str, unit: str, values: Array) -> Channel:
    """A channel in the notation's conventions."""
    q = quantity(symbol)
    column = ColumnSpec(symbol, symbol, unit)
    return Channel(frozen(values * column.si_factor(q.unit)), q.unit, q.frame, q.positive)


# One record file of any format.

# bytes of a file from which holes count, and share of it that must have been written at least; ours
_LARGE, _LEAST_WRITTEN = 64 * 2**20, 0.01


def read_record(path: Path, layout: Layout) -> Record:
    """Read one file: values in SI units, frames, signs and reference points as the layout declares them.

    Empty cells become NaN, an empty time stamp as well; `check` reports and repairs them.

    Raises:
        InputError: missing, empty or binary file, wrong encoding, column, unit or cell, time that runs backwards,
            a channel without numbers, fewer than two samples.
    """
    log = read_log(path, layout)
    return assemble_record(log, layout, file_digest(path))


def read_log(path: Path, layout: Layout) -> Log:
    """Read one file as its format has it: topics, columns, parameters, events.

    Raises:
        InputError: the file is missing, empty, damaged, or no regular file.
    """
    read = reader_of(layout.format)
    require_file(path)
    return read(path, layout)


def require_file(path: Path) -> None:
    """Raises:
    InputError: the path is missing, a folder, a device or a pipe, or a file that is empty or all but holes.
    """
    if is_folder(path):
        raise InputError(f"{path} is a folder; name a file in it")
    if not is_file(path):
        if not is_present(path):
            raise InputError(f"{path} does not exist; check the path and SEATRIAL_DATA")
        raise InputError(f"{path} is a device or a pipe; records are read from files, streams by 'seatrial follow'")
    if path.stat().st_size == 0:
        raise InputError(f"{path.name} is empty; leave it out or replace it")
    _refuse_hollow(path)


def _refuse_hollow(path: Path) -> None:
    """Raises:
    InputError: a large file is all but holes, through which some readers would go byte by byte.
    """
    facts = path.stat()
    if facts.st_size > _LARGE and (written := written_size(facts)) < _LEAST_WRITTEN * facts.st_size:
        raise InputError(
            f"{path.name} is damaged: of its {facts.st_size / 1e6:,.0f} MB only {written / 1e6:,.1f} MB were ever "
            "written; copy it again"
        )


def file_digest(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
