"""Journals of outcomes: appended by one process each, readable at any moment, whatever becomes of the writer.

A line of text (`seatrial campaign journal 1`), then frames, little-endian: `D` (done) or `F` (failed), length of the
body (u32), identity of the task (32 bytes), seconds (f64), body, CRC-32.
"""

import mmap
import os
import secrets
import socket
import struct
from dataclasses import dataclass
from io import FileIO
from pathlib import Path

from seatrial.campaigns.outcome import Outcome
from seatrial.core.values import InputError
from seatrial.core.values.files import FrameWriter, whole_frames
from seatrial.numerics.platform import flush_folder_to_disk

SUFFIX = ".journal"
_HEADER = b"seatrial campaign journal 1\n"
_HEADER_PREFIX = b"seatrial campaign journal "
_HEAD = struct.Struct("<cI32sd")
_DONE, _FAILED = b"D", b"F"
_NAME_BYTES = 4  # of the random part of a journal's name: chosen, no two alike on one machine and process number


class OutcomeJournal:
    """A new journal, to which one process appends."""

    def __init__(self, folder: Path, flush_s: float) -> None:
        """Create the file; flush_s: s between two flushes to the disk.

        Raises:
            InputError: it cannot be written.
        """
        name = f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(_NAME_BYTES)}{SUFFIX}"
        self.path = folder / name
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file: FileIO = self.path.open("xb", buffering=0)
            self._file.write(_HEADER)
            flush_folder_to_disk(folder)
        except OSError as error:
            raise self._sentence(error) from None
        self._writer = FrameWriter(self._file, flush_s)

    def append(self, outcome: Outcome) -> None:
        """Append an outcome; it survives this process from now on.

        Raises:
            InputError: the disk is full or has failed.
        """
        tag = _FAILED if outcome.is_failure else _DONE
        self._writer.append(_HEAD.pack(tag, len(outcome.body), outcome.identity, outcome.seconds) + outcome.body)
        try:
            self._writer.write_pending()
        except OSError as error:
            raise self._sentence(error) from None

    def close(self) -> None:
        """Write through to the disk and close; one without an outcome is removed.

        Raises:
            InputError: the disk is full or has failed.
        """
        try:
            self._writer.flush()
            is_empty = self._file.tell() == len(_HEADER)
            self._file.close()
            if is_empty:
                self.path.unlink(missing_ok=True)
        except OSError as error:
            raise self._sentence(error) from None

    def _sentence(self, error: OSError) -> InputError:
        return InputError(
            f"journal '{self.path}' cannot be written ({error.strerror}); what was finished before is kept: make room "
            "there and run the same command again"
        )


@dataclass(frozen=True)
class JournalEntry:
    """An outcome in a journal: where its body stands, so that it can be read when it is needed."""

    path: Path
    is_failure: bool
    identity: bytes
    seconds: float
    start: int
    stop: int


@dataclass(frozen=True)
class JournalContent:
    """The whole entries of a journal, and in how many places something between or behind them is damaged."""

    entries: tuple[JournalEntry, ...]
    damaged_places: int


def read_journal(path: Path) -> JournalContent:
    """Return the whole entries of a journal; a torn end is that of a process that was killed, or is writing now.

    Raises:
        InputError: it cannot be read, is no journal of a campaign, or one of a newer version.
    """
    try:
        with path.open("rb") as file:
            header = file.read(len(_HEADER))
            if len(header) < len(_HEADER) and _HEADER.startswith(header):  # its writer was killed at once
                return JournalContent((), 0)
            _check_header(header, path)
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                return _parsed(content, path)
    except OSError as error:
        raise InputError(f"journal '{path}' cannot be read ({error.strerror}); check its permissions") from None


def body_of(entry: JournalEntry) -> bytes:
    """Return the body of an entry."""
    with entry.path.open("rb") as file:
        file.seek(entry.start)
        return file.read(entry.stop - entry.start)


def _check_header(header: bytes, path: Path) -> None:
    if header == _HEADER:
        return
    if header.startswith(_HEADER_PREFIX):
        raise InputError(f"journal '{path}' is of a newer version of seatrial; update this one")
    raise InputError(f"'{path}' is no journal of a campaign; remove it from the store")


def _parsed(content: mmap.mmap, path: Path) -> JournalContent:
    entries, damaged, end = list[JournalEntry](), 0, len(_HEADER)
    for frame in whole_frames(content, end, _payload_size):
        tag, length, identity, seconds = _HEAD.unpack_from(content, frame.start)
        body = frame.start + _HEAD.size
        entries.append(JournalEntry(path, tag == _FAILED, identity, seconds, body, body + length))
        damaged += frame.start > end
        end = frame.stop
    return JournalContent(tuple(entries), damaged)


def _payload_size(content: bytes | mmap.mmap, offset: int) -> int:
    """Return the bytes of the payload that begins at `offset`; 0 where none can begin."""
    if content[offset : offset + 1] not in (_DONE, _FAILED) or offset + _HEAD.size > len(content):
        return 0
    return _HEAD.size + int.from_bytes(content[offset + 1 : offset + 5], "little")
