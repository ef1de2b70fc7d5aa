"""One record file of any format."""

import hashlib
from pathlib import Path

from seatrial.core.values import InputError, Record
from seatrial.core.values.files import is_file, is_folder, is_present
from seatrial.data.read.assemble import assemble_record
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log
from seatrial.data.read.registry import reader_of
from seatrial.numerics.platform import written_size

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
