"""Files to records, one format a file: parses and converts units, judges nothing."""

import hashlib
from pathlib import Path

from seatrial.core.values import InputError, Record, spelling_hint
from seatrial.data.read.assemble import assemble_record
from seatrial.data.read.layout import ColumnSpec, Format, Layout
from seatrial.data.read.mat import read_mat
from seatrial.data.read.netcdf import read_netcdf
from seatrial.data.read.parquet import read_parquet
from seatrial.data.read.raw_table import Reader
from seatrial.data.read.record_csv import read_record_csv, write_record_csv
from seatrial.data.read.text import read_text

READERS: dict[Format, Reader] = {"text": read_text, "mat": read_mat, "parquet": read_parquet, "netcdf": read_netcdf}

_SUFFIXES: dict[str, Format] = {
    ".csv": "text",
    ".tsv": "text",
    ".txt": "text",
    ".dat": "text",
    ".asc": "text",
    ".mat": "mat",
    ".parquet": "parquet",
    ".pq": "parquet",
    ".nc": "netcdf",
    ".nc4": "netcdf",
    ".netcdf": "netcdf",
}


def format_of(path: Path) -> Format:
    """The format a file's suffix promises (``.gz`` is looked through).

    Raises:
        InputError: the suffix is not known.
    """
    suffix = Path(path.name.removesuffix(".gz")).suffix.lower()
    if suffix not in _SUFFIXES:
        raise InputError(
            f"{path.name}: the format cannot be told from '{suffix}'; give format = one of {_known_formats()}"
        )
    return _SUFFIXES[suffix]


def read_record(path: Path, layout: Layout) -> Record:
    """Read one file: values in SI units, frames, signs and reference points as the layout declares them.

    Empty cells become NaN, an empty time stamp as well; `check` reports and repairs them.

    Raises:
        InputError: missing, empty or binary file, wrong encoding, column, unit or cell, time that runs backwards,
            a channel without numbers, fewer than two samples.
    """
    if layout.format not in READERS:
        raise InputError(f"unknown format '{layout.format}'{spelling_hint(layout.format, sorted(READERS))}")
    if not path.is_file():
        raise InputError(f"{path} does not exist; check the path and SEATRIAL_DATA")
    if path.stat().st_size == 0:
        raise InputError(f"{path.name} is empty; leave it out or replace it")
    sheet = READERS[layout.format](path, layout)
    return assemble_record(sheet, layout, hashlib.sha256(path.read_bytes()).hexdigest())


def _known_formats() -> str:
    return ", ".join(sorted(READERS))


__all__ = [
    "READERS",
    "ColumnSpec",
    "Format",
    "Layout",
    "format_of",
    "read_record",
    "read_record_csv",
    "write_record_csv",
]
