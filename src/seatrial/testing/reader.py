"""A reader of record files: checked on a file that it reads and on damaged copies of it."""

import hashlib
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.data.read.assemble import assemble_record
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, Reader
from seatrial.data.read.record_file import read_record_csv, write_record_csv
from seatrial.testing.conformance import ConformanceError, require, require_refusal

# shares of its length to which a sample file is cut, dimensionless; ours: in the header, in the middle, in the last row
CUTS = (0.02, 0.5, 0.99)
# copies with bytes changed at random places, and how many bytes in each; ours
DAMAGED_COPIES, DAMAGED_BYTES = 4, 8


def check_reader(read: Reader, path: str | Path, layout: Layout) -> None:
    """Check a reader on a sample file: topics of equal columns, SI values, refusals, nothing written.

    Args:
        read: takes a path and a layout and returns a `Log`, as the entry points of ``seatrial.readers`` do.
        path: a sample file of at least two rows.
        layout: what the file holds; its columns must include all that the sample is read for.

    Raises:
        ConformanceError: the first violation.
    """
    path = Path(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    log = read(path, layout)
    _check_log(log, path)
    record = assemble_record(log, layout, digest)
    require(len(record) >= 2, "the sample gives fewer than two samples")
    again = assemble_record(read(path, layout), layout, digest)
    for symbol in record.channels:
        same = np.array_equal(record[symbol], again[symbol], equal_nan=True)
        require(same, f"reading twice gives other numbers in channel '{symbol}'")
    require(np.array_equal(record.time, again.time, equal_nan=True), "reading twice gives other time stamps")
    require(hashlib.sha256(path.read_bytes()).hexdigest() == digest, "the reader changes the file that it reads")
    unknown = replace(layout, columns=(*layout.columns[1:], replace(layout.columns[0], source="no such column")))
    require_refusal(
        lambda: assemble_record(read(path, unknown), unknown, digest), InputError, "a column that is missing"
    )
    with tempfile.TemporaryDirectory() as folder:
        _check_round_trip(record, Path(folder) / "record.csv")
        _check_damage(read, path, layout, Path(folder))


def _check_log(log: Log, path: Path) -> None:
    """Check the shape of what a reader returns."""
    require(isinstance(log, Log), f"the reader returns a {type(log).__name__}, not a Log")
    require(log.file == path.name, f"the log names the file '{log.file}', not '{path.name}'")
    for topic in log.topics:
        require(log.topics.count(topic) == 1, f"the topic '{topic}' stands twice; number them")
    for table in log.tables:
        _check_table(table, path)
    times = [event.time for event in log.events]
    require(times == sorted(times), "the events are not in order of time")


def _check_table(table: RawTable, path: Path) -> None:
    """Check the shape of one topic."""
    require(table.file == path.name, f"the table names the file '{table.file}', not '{path.name}'")
    require(len(table.names) == len(table.cells), f"{len(table.names)} names for {len(table.cells)} columns")
    lengths = {len(column) for column in table.cells}
    require(len(lengths) == 1, f"columns differ in length: {sorted(lengths)}")
    require(not table.units or len(table.units) == len(table.names), "there is a unit for some columns only")
    require(
        not table.time_name or table.time_name in table.names,
        f"topic '{table.topic}': its time column '{table.time_name}' is none of its columns",
    )
    require(table.first_row >= 0, f"first_row is {table.first_row}; it is the line or row of the first cell")


def _check_round_trip(record: Record, path: Path) -> None:
    """Check that the record survives being written and read."""
    write_record_csv(record, path)
    restored = read_record_csv(path)
    for symbol in record.channels:
        same = np.array_equal(restored[symbol], record[symbol], equal_nan=True)
        require(same, f"channel '{symbol}' changes when the record is written and read again")


def _check_damage(read: Reader, path: Path, layout: Layout, folder: Path) -> None:
    """Check that a missing, an empty and a cut file end in an InputError or in a table, never in another exception."""
    copy = folder / path.name
    content = path.read_bytes()
    for occasion, damaged in (("an empty file", b""), ("a file of zero bytes only", bytes(len(content)))):
        copy.write_bytes(damaged)
        require_refusal(lambda: read(copy, layout), InputError, occasion)
    damages = {f"a file cut to {share:.0%}": content[: int(share * len(content))] for share in CUTS}
    rng = np.random.default_rng(0)
    for number in range(1, DAMAGED_COPIES + 1):
        spoilt = bytearray(content)
        for place in rng.integers(0, len(content), DAMAGED_BYTES):
            spoilt[place] = rng.integers(0, 256)  # any byte
        damages[f"copy {number} with bytes changed"] = bytes(spoilt)
    for occasion, damaged in damages.items():
        copy.write_bytes(damaged)
        try:
            read(copy, layout)
        except InputError:
            continue
        except Exception as error:
            raise ConformanceError(
                f"{occasion} raises {type(error).__name__} ({error}); raise InputError with one sentence"
            ) from error
