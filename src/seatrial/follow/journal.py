"""What was admitted, on disk: appended, a checksum for each entry, so that a torn end is told from what was written.

A line of text (`seatrial journal 1 IDENTITY COLUMNS`), then entries, little-endian: `S`, number of the sample in its
source (u64), time (f64), values (f64 each), CRC-32; `R`, length (u16), name of the run that begins (UTF-8), CRC-32.
"""

import hashlib
import os
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import BinaryIO

import numpy as np

from seatrial.equations import Model
from seatrial.follow.sample import Sample
from seatrial.read import Layout
from seatrial.values import InputError

_MARK = b"seatrial journal 1 "
_CRC = struct.Struct("<I")
_SAMPLE, _RUN = b"S", b"R"
_FLUSH_S = 1.0
# what a break can tear off: what a second may hold, far less than a voyage
_TORN_AT_MOST = 1 << 18
_PIECE = 1 << 20


@dataclass(frozen=True)
class Begin:
    """A run begins."""

    name: str


@dataclass(frozen=True, eq=False)
class Admitted:
    """A sample was admitted; number: how many samples its source had given by then, itself included."""

    sample: Sample
    number: int


Entry = Begin | Admitted


def identity_of(model: Model, layout: Layout) -> str:
    """SHA-256 of what a journal belongs to: the equations, and the columns with their units, frames and signs."""
    return hashlib.sha256(f"{model.equation_hash} {layout.time} {layout.columns}".encode()).hexdigest()


class Journal:
    """An open journal: first `entries` of what is there, then `begin` and `admit`, on disk within a second.

    Attributes:
        path: the file; torn: bytes that a break had left half-written, cut off; trouble: why nothing more is written.
    """

    def __init__(self, path: Path, identity: str, columns: int, clock: Callable[[], float] = monotonic) -> None:
        """Make or open a journal of `columns` values a sample.

        Raises:
            InputError: it cannot be written, is none, belongs to another trial, or is open elsewhere.
        """
        self.path, self.torn, self.trouble = path, 0, ""
        self._sample = struct.Struct(f"<cQ{1 + columns}d")
        self._clock, self._flushed = clock, clock()
        header = _MARK + f"{identity} {columns}\n".encode()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: BinaryIO = path.open("r+b" if path.exists() else "x+b")
        except OSError as error:
            raise InputError(f"journal '{path}' cannot be written ({error.strerror}); choose another place") from None
        try:
            _lock(self._file, path)
            self._begun = _headed(self._file, header, path)
        except InputError:
            self._file.close()
            raise

    def entries(self) -> Iterator[Entry]:
        """What the journal holds, in order; a torn end is cut off, so that writing goes on behind the last whole entry.

        Raises:
            InputError: damage that no break explains.
        """
        place = self._begun
        self._file.seek(place)
        left = b""
        while piece := self._file.read(_PIECE):
            left += piece
            used = 0
            while (found := self._entry(left, used)) is not None:
                entry, size = found
                used += size
                yield entry
            place, left = place + used, left[used:]
            if len(left) > _TORN_AT_MOST:
                raise InputError(
                    f"journal '{self.path}' is damaged at byte {place}, long before its end; move it elsewhere"
                )
        self.torn = len(left)
        self._file.truncate(place)
        self._file.seek(place)

    def begin(self, name: str) -> None:
        """Note that a run begins."""
        text = name.encode()[: 2**16 - 1]
        self._write(_RUN + struct.pack("<H", len(text)) + text)

    def admit(self, sample: Sample, number: int) -> None:
        """Note a sample, the `number`-th of its source."""
        self._write(self._sample.pack(_SAMPLE, number, sample.time, *sample.values))

    def settle(self) -> None:
        """Bring to disk what has been noted, where a second has passed since the last time."""
        if self._clock() - self._flushed >= _FLUSH_S:
            self.flush()

    def flush(self) -> None:
        """Bring to disk what has been noted."""
        self._flushed = self._clock()
        self._try(self._synchronised)

    def close(self) -> None:
        """Bring everything to disk and give the file back."""
        if not self._file.closed:
            self.flush()
            self._try(self._file.close)

    def _entry(self, data: bytes, at: int) -> tuple[Entry, int] | None:
        """The whole entry at that place and its size; None if there is none."""
        tag = data[at : at + 1]
        if tag == _SAMPLE:
            size = self._sample.size
        elif tag == _RUN and len(data) >= at + 3:
            size = 3 + struct.unpack_from("<H", data, at + 1)[0]
        else:
            return None
        if len(data) < at + size + _CRC.size:
            return None
        if _CRC.unpack_from(data, at + size)[0] != zlib.crc32(data[at : at + size]):
            return None
        if tag == _RUN:
            return Begin(data[at + 3 : at + size].decode(errors="replace")), size + _CRC.size
        _, number, time, *values = self._sample.unpack_from(data, at)
        return Admitted(Sample(time, np.array(values)), number), size + _CRC.size

    def _write(self, entry: bytes) -> None:
        self._try(lambda: self._file.write(entry + _CRC.pack(zlib.crc32(entry))))

    def _synchronised(self) -> None:
        self._file.flush()
        os.fsync(self._file.fileno())

    def _try(self, act: Callable[[], object]) -> None:
        """A full disk ends the journal, not the voyage."""
        if self.trouble:
            return
        try:
            act()
        except OSError as error:
            self.trouble = f"journal '{self.path}' is no longer written ({error.strerror}); make room and start again"


def _headed(file: BinaryIO, header: bytes, path: Path) -> int:
    """Write or check the header; where entries begin."""
    found = file.read(len(header))
    if header.startswith(found):
        file.seek(0)
        file.truncate(0) if len(found) < len(header) else None
        file.write(header)
        file.flush()
    elif not found.startswith(_MARK):
        raise InputError(f"'{path}' is no journal of 'seatrial follow'; name another file")
    elif found != header:
        raise InputError(
            f"journal '{path}' belongs to another model or other columns; name another one, or move it elsewhere"
        )
    return len(header)


def _lock(file: BinaryIO, path: Path) -> None:
    """One writer at a time, where the system can tell."""
    try:
        import fcntl
    except ImportError:
        return
    try:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise InputError(
            f"journal '{path}' is being written by another process; end that one, or name another"
        ) from None
