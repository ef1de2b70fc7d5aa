"""Files of entries that are only ever appended, each with its CRC-32: a torn end and damage in between are recognised.

A frame is a payload and its checksum (u32, little-endian). How long a payload is, the payload itself says: each kind of
file has its own function for that.
"""

import errno
import os
import struct
import zlib
from collections.abc import Callable, Iterator
from io import RawIOBase
from mmap import mmap
from time import monotonic

from seatrial.numerics.platform import flush_to_disk

_CRC = struct.Struct("<I")
PayloadSize = Callable[[bytes | mmap, int], int]
"""(content, offset) -> bytes of the payload that begins there; 0 where none can begin."""


def whole_frames(content: bytes | mmap, start: int, payload_size: PayloadSize) -> Iterator[range]:
    """Yield the bytes of every frame whose checksum holds, checksum included; behind damage, from the next one on."""
    offset, size = start, len(content)
    while offset < size:
        length = payload_size(content, offset)
        end = offset + length
        if length and end + _CRC.size <= size:
            stored = int.from_bytes(content[end : end + _CRC.size], "little")
            if stored == zlib.crc32(content[offset:end]):
                yield range(offset, end + _CRC.size)
                offset = end + _CRC.size
                continue
        offset += 1


class FrameWriter:
    """Appends frames to an open file: to the operating system at once, through to the disk in groups."""

    def __init__(self, file: RawIOBase, flush_s: float, clock: Callable[[], float] = monotonic) -> None:
        """Write at the file's position; flush_s: s between two flushes to the disk."""
        self._file, self._flush_s, self._clock, self._flushed_at = file, flush_s, clock, clock()
        self._pending: list[bytes] = []

    def append(self, payload: bytes) -> None:
        """Append a frame, to be written by `write_pending`."""
        self._pending.append(payload + _CRC.pack(zlib.crc32(payload)))

    def write_pending(self) -> None:
        """Hand the frames to the operating system, where they survive this process; when it is time also to the disk.

        Raises:
            OSError: the disk is full or has failed.
        """
        data, self._pending = b"".join(self._pending), []
        if data and self._file.write(data) != len(data):  # half a frame must be the last
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        if self._clock() - self._flushed_at >= self._flush_s:
            self._flushed_at = self._clock()
            flush_to_disk(self._file.fileno())

    def flush(self) -> None:
        """Write all frames through to the disk now; errors as in `write_pending`."""
        self._flushed_at = -self._flush_s
        self.write_pending()
