"""One record file of any format."""

import hashlib
from pathlib import Path

from seatrial.core.values import InputError, Record
from seatrial.data.read.assemble import assemble_record
from seatrial.data.read.layout import Layout
from seatrial.data.read.registry import reader_of


def read_record(path: Path, layout: Layout) -> Record:
    """Read one file: values in SI units, frames, signs and reference points as the layout declares them.

    Empty cells become NaN, an empty time stamp as well; `check` reports and repairs them.

    Raises:
        InputError: missing, empty or binary file, wrong encoding, column, unit or cell, time that runs backwards,
            a channel without numbers, fewer than two samples.
    """
    read = reader_of(layout.format)
    if not path.is_file():
        raise InputError(f"{path} does not exist; check the path and SEATRIAL_DATA")
    if path.stat().st_size == 0:
        raise InputError(f"{path.name} is empty; leave it out or replace it")
    return assemble_record(read(path, layout), layout, hashlib.sha256(path.read_bytes()).hexdigest())
