"""The samples accepted, on disk: appended, with a checksum for each entry, so that a torn end is recognised.

A line of text (`seatrial journal 1 IDENTITY COLUMNS`), then entries, little-endian: `S`, time and values (f64 each),
CRC-32; `R`, length (u16), why a run begins (UTF-8), CRC-32.
"""

import hashlib
import mmap
import os
import struct
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import RawIOBase
from pathlib import Path
from time import monotonic

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.online import Sample
from seatrial.core.values import InputError
from seatrial.core.values.files import FrameWriter, whole_frames
from seatrial.data.read import Layout
from seatrial.numerics.platform import lock_exclusively

_HEADER_PREFIX = b"seatrial journal 1 "
_SAMPLE_TAG, _RUN_TAG = b"S", b"R"
_SAMPLE_HEAD = struct.Struct("<cd")
# s between two flushes: with the wait for samples, an entry is on disk within a second
_FLUSH_S = 0.7
# bytes that a break can tear off; chosen: more than a second of samples, far less than a run
_MAX_TORN = 1 << 18


@dataclass(frozen=True)
class RunEntry:
    """The start of a run; reason: in words."""

    reason: str


JournalEntry = RunEntry | Sample


def journal_identity(model: Model, layout: Layout) -> str:
    """Return the SHA-256 of what a journal belongs to: equations, and columns with their units, frames and signs."""
    return hashlib.sha256(f"{model.equation_hash} {layout.time} {layout.columns}".encode()).hexdigest()


class Journal:
    """An open journal: `entries` that it held, `append` and `write_pending` new ones.

    Attributes:
        path: the file.
        torn_bytes: bytes half-written before a break, which were cut off.
        damaged_places: stretches between whole entries that were skipped.
        write_error: why nothing more is written; empty while all is well.
    """

    def __init__(self, path: Path, identity: str, columns: int, clock: Callable[[], float] = monotonic) -> None:
        """Create or open a journal of `columns` values a sample.

        Raises:
            InputError: it cannot be written, is not a journal, belongs to another trial, is open elsewhere, or has
                damage that a break cannot explain.
        """
        self.path, self.torn_bytes, self.damaged_places, self.write_error = path, 0, 0, ""
        self._columns, self._sample_size = columns, _SAMPLE_HEAD.size + 8 * columns  # bytes of a float64
        self._frames = array("q")  # offsets of the whole entries
        header = _HEADER_PREFIX + f"{identity} {columns}\n".encode()
        if path.exists() and not path.is_file():
            raise InputError(f"journal '{path}' is a folder, pipe or device; name a file")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: RawIOBase = path.open("r+b" if path.exists() else "x+b", buffering=0)
        except OSError as error:
            raise InputError(f"journal '{path}' cannot be written ({error.strerror}); choose another place") from None
        try:
            if not lock_exclusively(self._file):
                raise InputError(
                    f"journal '{path}' is being written by another process; end that process, or name another journal"
                )
            self._recover(_check_header(self._file, header, path))
            self._writer = FrameWriter(self._file, _FLUSH_S, clock)
        except InputError:
            self._file.close()
            raise

    def entries(self) -> Iterator[JournalEntry]:
        """Yield the entries that the journal held when it was opened, in order, also while others are appended."""
        for offset in self._frames:
            yield self._parsed(offset)

    @property
    def is_empty(self) -> bool:
        """Whether it held no entry when it was opened."""
        return not self._frames

    def append(self, entry: JournalEntry) -> None:
        """Append an entry, to be written by `write_pending`; after a write error it is dropped."""
        if self.write_error:
            return
        match entry:
            case Sample(time=time, values=values):
                data = _SAMPLE_HEAD.pack(_SAMPLE_TAG, time) + values.astype("<f8").tobytes()
            case RunEntry(reason=reason):
                text = reason.encode()[: 2**16 - 1]
                data = _RUN_TAG + struct.pack("<H", len(text)) + text
        self._writer.append(data)

    def write_pending(self) -> None:
        """Hand entries to the operating system, where they survive this process; every 0.7 s also to the disk."""
        self._try_write(self._writer.write_pending)

    def flush(self) -> None:
        """Write all entries through to the disk now."""
        self._try_write(self._writer.flush)

    def close(self) -> None:
        """Write all entries through to the disk and close the file."""
        if not self._file.closed:
            self.flush()
            self._content.close()  # it holds the file, and with it the lock
            self._try_write(self._file.close)

    def _recover(self, start: int) -> None:
        """Find the whole entries, skip what is damaged between them, and cut off a torn end."""
        size, end = self._file.seek(0, os.SEEK_END), start
        self._content = mmap.mmap(self._file.fileno(), size, access=mmap.ACCESS_READ)
        for frame in whole_frames(self._content, start, self._entry_size):
            self.damaged_places += frame.start > end
            self._frames.append(frame.start)
            end = frame.stop
        self.torn_bytes = size - end
        if self.torn_bytes > _MAX_TORN:
            self._content.close()
            raise InputError(f"journal '{self.path}' is damaged at byte {end}, long before its end; move it elsewhere")
        self._file.truncate(end)
        self._file.seek(end)

    def _entry_size(self, data: bytes | mmap.mmap, offset: int) -> int:
        """Return the bytes of the entry that begins at `offset`, without its checksum; 0 where none can begin."""
        tag = data[offset : offset + 1]
        if tag == _RUN_TAG and len(data) >= offset + 3:
            return 3 + struct.unpack_from("<H", data, offset + 1)[0]
        return self._sample_size if tag == _SAMPLE_TAG else 0

    def _parsed(self, offset: int) -> JournalEntry:
        """Return the entry that begins at `offset`."""
        data = self._content
        if data[offset : offset + 1] == _RUN_TAG:
            length = struct.unpack_from("<H", data, offset + 1)[0]
            return RunEntry(data[offset + 3 : offset + 3 + length].decode(errors="replace"))
        values = np.frombuffer(data[offset + _SAMPLE_HEAD.size : offset + self._sample_size], "<f8").astype(np.float64)
        return Sample(_SAMPLE_HEAD.unpack_from(data, offset)[1], values)

    def _try_write(self, action: Callable[[], object]) -> None:
        """Do it; an error (a full disk) ends the journal, not the estimation."""
        if self.write_error:
            return
        try:
            action()
        except OSError as error:
            self.write_error = (
                f"journal '{self.path}' is no longer written ({error.strerror}); free disk space and start again"
            )


def _check_header(file: RawIOBase, header: bytes, path: Path) -> int:
    """Write or check the header, and return the offset at which entries begin."""
    present = file.read(len(header))
    if header.startswith(present):
        file.seek(0)
        file.truncate(0) if len(present) < len(header) else None
        file.write(header)
    elif not present.startswith(_HEADER_PREFIX):
        raise InputError(f"'{path}' is not a journal of 'seatrial follow'; name another file")
    elif present != header:
        raise InputError(
            f"journal '{path}' belongs to another model or other columns; name another one, or move it elsewhere"
        )
    return len(header)
