"""What was admitted, on disk: appended, a checksum for each entry, so that a torn end is told from what was written.

A line of text (`seatrial journal 1 IDENTITY COLUMNS`), then entries, little-endian: `S`, time and values (f64 each),
CRC-32; `R`, length (u16), why a run begins (UTF-8), CRC-32.
"""

import errno
import hashlib
import os
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import RawIOBase
from pathlib import Path
from time import monotonic

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.data.read import Layout
from seatrial.onboard.sample import Sample

_MARK = b"seatrial journal 1 "
_CRC = struct.Struct("<I")
_SAMPLE, _RUN = b"S", b"R"
_TIMED = struct.Struct("<cd")
# with the wait for samples, on disk within a second
_FLUSH_S = 0.7
# what a break can tear off: what a second may hold, far less than a voyage
_TORN_AT_MOST = 1 << 18
_PIECE = 1 << 20


@dataclass(frozen=True)
class Begin:
    """A run begins, and why."""

    reason: str


Entry = Begin | Sample


def identity_of(model: Model, layout: Layout) -> str:
    """SHA-256 of what a journal belongs to: the equations, and the columns with their units, frames and signs."""
    return hashlib.sha256(f"{model.equation_hash} {layout.time} {layout.columns}".encode()).hexdigest()


class Journal:
    """An open journal: first `entries` of what is there; then what is noted is written by `settle`.

    Attributes:
        path: the file; torn: bytes that a break had left half-written, cut off; trouble: why nothing more is written.
    """

    def __init__(self, path: Path, identity: str, columns: int, clock: Callable[[], float] = monotonic) -> None:
        """Make or open a journal of `columns` values a sample.

        Raises:
            InputError: it cannot be written, is none, belongs to another trial, or is open elsewhere.
        """
        self.path, self.torn, self.trouble = path, 0, ""
        self._columns, self._size = columns, _TIMED.size + 8 * columns
        self._noted: list[bytes] = []
        self._clock, self._flushed = clock, clock()
        header = _MARK + f"{identity} {columns}\n".encode()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: RawIOBase = path.open("r+b" if path.exists() else "x+b", buffering=0)
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

    def note(self, entry: Entry) -> None:
        """Note what happened next."""
        match entry:
            case Sample(time=time, values=values):
                made = _TIMED.pack(_SAMPLE, time) + values.astype("<f8").tobytes()
            case Begin(reason=reason):
                text = reason.encode()[: 2**16 - 1]
                made = _RUN + struct.pack("<H", len(text)) + text
        self._noted.append(made + _CRC.pack(zlib.crc32(made)))

    def settle(self) -> None:
        """Hand what was noted to the system, which survives this process; to the disk where a second has passed."""
        data, self._noted = b"".join(self._noted), []
        if data:
            self._try(lambda: _written(self._file, data))
        if self._clock() - self._flushed >= _FLUSH_S:
            self._flushed = self._clock()
            self._try(lambda: os.fsync(self._file.fileno()))

    def flush(self) -> None:
        """All of it to the disk, now."""
        self._flushed = -_FLUSH_S
        self.settle()

    def close(self) -> None:
        """Bring everything to disk and give the file back."""
        if not self._file.closed:
            self.flush()
            self._try(self._file.close)

    def _entry(self, data: bytes, at: int) -> tuple[Entry, int] | None:
        """The whole entry at that place and its size; None if there is none."""
        tag = data[at : at + 1]
        if tag == _SAMPLE:
            size = self._size
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
        values = np.frombuffer(data, "<f8", self._columns, at + _TIMED.size).astype(np.float64)
        return Sample(_TIMED.unpack_from(data, at)[1], values), size + _CRC.size

    def _try(self, act: Callable[[], object]) -> None:
        """A full disk ends the journal, not the voyage."""
        if self.trouble:
            return
        try:
            act()
        except OSError as error:
            self.trouble = f"journal '{self.path}' is no longer written ({error.strerror}); make room and start again"


def _written(file: RawIOBase, data: bytes) -> None:
    """All of it, or an error: half an entry must be the last."""
    if file.write(data) != len(data):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _headed(file: RawIOBase, header: bytes, path: Path) -> int:
    """Write or check the header; where entries begin."""
    found = file.read(len(header))
    if header.startswith(found):
        file.seek(0)
        file.truncate(0) if len(found) < len(header) else None
        file.write(header)
    elif not found.startswith(_MARK):
        raise InputError(f"'{path}' is no journal of 'seatrial follow'; name another file")
    elif found != header:
        raise InputError(
            f"journal '{path}' belongs to another model or other columns; name another one, or move it elsewhere"
        )
    return len(header)


def _lock(file: RawIOBase, path: Path) -> None:
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
