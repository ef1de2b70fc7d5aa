"""Files written whole or not at all, files that only grow, tables read within limits."""

import errno
import json
import math
import os
import re
import secrets
import shutil
import struct
import tempfile
import tomllib
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping, Set
from contextlib import contextmanager, suppress
from io import RawIOBase
from itertools import islice
from mmap import mmap
from pathlib import Path
from time import monotonic
from typing import Any

from seatrial.core.values.errors import InputError
from seatrial.numerics.platform import (
    exchange_folders,
    flush_folder_to_disk,
    flush_to_disk,
    held_lock,
    open_without_waiting,
    replace_file,
    write_to_device,
)

# Files and folders written whole or not at all: beside the target, through to the disk, then put in its place.

_DRAFT = ".writing-"  # begins the names of files and folders that are being written
_MOST_ADOPTED = 1000  # entries, folders within included, of a folder that is replaced as one: chosen
_DRAFT_BYTES = 6  # of the random part of such a name: chosen, 2**48 names


def is_file(path: Path) -> bool:
    """Return whether there is a regular file; False also for what cannot be a name: too long, with a zero byte."""
    return os.path.isfile(path)  # noqa: PTH113  Path.is_file raises on such names


def is_folder(path: Path) -> bool:
    """Return whether there is a folder; False as in `is_file`."""
    return os.path.isdir(path)  # noqa: PTH112


def is_present(path: Path) -> bool:
    """Return whether there is anything of that name; False as in `is_file`."""
    return os.path.exists(path)  # noqa: PTH110


def is_device_or_pipe(path: Path) -> bool:
    """Return whether there is something that is neither file nor folder, such as /dev/stdout or a named pipe."""
    return is_present(path) and not (is_file(path) or is_folder(path))


def plain_name(name: str) -> str:
    """Return the name of a file with "_" for letters that cannot be shown: control characters, bytes of no encoding."""
    return "".join(letter if letter.isprintable() else "_" for letter in name)


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file beside the target, then rename it; a symbolic link is written through, and so is a device or pipe.

    Raises:
        InputError: the place cannot be written, or is a pipe that nobody reads.
    """
    with _sentence(f"'{path}'"):
        if is_device_or_pipe(path):
            write_to_device(path, content)
            return
        target = path.resolve()
        draft = target.with_name(_draft_name())
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            _write(draft, content)
            replace_file(draft, target)
        finally:
            draft.unlink(missing_ok=True)


def write_files_atomically(folder: Path, contents: Mapping[str, bytes], removed: Collection[str] = frozenset()) -> Path:
    """Write files of a folder, all or none, and return the folder; other files in it stay, but for those `removed`.

    The folder is built anew beside the old one and the two are exchanged in one step, so that a process killed at any
    moment leaves the old files or the new ones. Only where that is impossible, because the folder holds the working
    directory or over a thousand entries, is a mount point, stands in a folder that may not be written, or lies on a
    file system without exchange or hard links, are files renamed into it one by one.

    Raises:
        InputError: the folder cannot be written.
    """
    with _sentence(f"folder '{folder}'"):
        target = folder.resolve()
    with _sentence(f"folder '{folder}'"), _new_parents(target.parent):
        try:
            _write_by_draft(target.parent, target, contents, {*removed} - {*contents})
        except OSError:
            if not target.is_dir():
                raise
            _write_by_draft(target, target, contents, {*removed} - {*contents})
    return folder


def _write_by_draft(place: Path, target: Path, contents: Mapping[str, bytes], removed: Set[str]) -> None:
    """Write files to a draft of a folder in `place`, which is its parent or itself, and put them where they belong."""
    _remove_abandoned_drafts(place, target.name)
    draft = place / _folder_draft_name(target)
    draft.mkdir()
    try:
        with held_lock(draft):
            for name, content in contents.items():
                _write(draft / name, content)
            _put_in_place(draft, target, contents, removed)
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def remove_file(path: Path) -> None:
    """Remove a file if it is there.

    Raises:
        InputError: it cannot be removed.
    """
    with _sentence(f"'{path}'"):
        path.unlink(missing_ok=True)


def writable_folder(folder: Path) -> Path:
    """The folder, after a test of writing to it: before the work, not after. One that was absent is absent again.

    Raises:
        InputError: it cannot be made or written.
    """
    with _sentence(f"folder '{folder}'"):
        target = folder.resolve()
        if is_present(target):
            target.mkdir(exist_ok=True)  # where it is a file, this says so
            with tempfile.TemporaryFile(dir=target):
                return folder
        absent = _absent(target.parent)
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            draft = target.with_name(_folder_draft_name(target))  # not the folder itself, should this process be killed
            draft.mkdir()
            draft.rmdir()
        finally:
            for place in absent:
                if place.is_dir():
                    place.rmdir()
    return folder


def _draft_name() -> str:
    return _DRAFT + secrets.token_hex(_DRAFT_BYTES)


def _folder_draft_name(target: Path) -> str:
    return f".{target.name}{_draft_name()}"


def _write(path: Path, content: bytes) -> None:
    with path.open("xb") as file:  # made with the permissions that the user's umask gives
        file.write(content)
        file.flush()
        flush_to_disk(file.fileno())


def _put_in_place(draft: Path, target: Path, contents: Mapping[str, bytes], removed: Set[str]) -> None:
    if not target.exists():
        flush_folder_to_disk(draft)
        replace_file(draft, target)
    elif not (
        draft.parent == target.parent
        and _adopt_others(draft, target, removed | contents.keys())
        and exchange_folders(draft, target)
    ):
        for name in contents:
            replace_file(draft / name, target / name)
        for name in removed:
            (target / name).unlink(missing_ok=True)
    flush_folder_to_disk(target.parent)


def _adopt_others(draft: Path, target: Path, replaced: Set[str]) -> bool:
    """Link the user's other files and folders into the draft of a folder's successor; False where that cannot be."""
    if Path.cwd().is_relative_to(target) or _holds_many(target):
        return False
    shutil.copymode(target, draft)
    try:
        for entry in target.iterdir():
            if entry.name in replaced:
                continue
            if entry.is_dir() and not entry.is_symlink():
                shutil.copytree(entry, draft / entry.name, symlinks=True, copy_function=os.link)
            else:
                os.link(entry, draft / entry.name, follow_symlinks=False)
    except OSError:  # another device, or a system without links
        return False
    flush_folder_to_disk(draft)
    return True


def _holds_many(folder: Path) -> bool:
    """Whether a folder holds so much that it is a working folder of the user, which keeps its identity."""
    return len(list(islice(folder.rglob("*"), _MOST_ADOPTED + 1))) > _MOST_ADOPTED


def _remove_abandoned_drafts(place: Path, name: str) -> None:
    """Remove drafts of a folder of that name whose process has ended without doing so."""
    for draft in place.glob(f".{_literal(name)}{_DRAFT}*"):
        with held_lock(draft) as locked:
            if locked:
                shutil.rmtree(draft, ignore_errors=True)


def _literal(name: str) -> str:
    """The pattern that a name alone matches."""
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)


def _absent(folder: Path) -> list[Path]:
    return [place for place in (folder, *folder.parents) if not is_present(place)]


@contextmanager
def _new_parents(folder: Path) -> Iterator[None]:
    """Make a folder, and remove it again where the body fails and it was absent."""
    absent = _absent(folder)
    folder.mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        with suppress(OSError):  # another process has written there meanwhile
            for place in absent:
                place.rmdir()
        raise


@contextmanager
def _sentence(place: str) -> Iterator[None]:
    """Turn an error of the system into a sentence about the place."""
    try:
        yield
    except (OSError, RuntimeError, ValueError) as error:  # of links in a circle, of a name with a zero byte
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{place} cannot be written ({reason}); choose another place") from None


# Files of entries that are only ever appended, each with its CRC-32: a torn end and damage in between are recognised.

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


# Tables of TOML and JSON files: read within a size, parsed within a depth, whole numbers within 64 bits.

# bytes of a file of tables, at most: 64 times the largest that the package writes; chosen
_LARGEST_FILE = 2**28
# sizes of a number of a trial or loop file, unless it is 0 or infinite, in any unit: 1e30 N m exceeds what the heaviest
# ship can meet by 1e16, and its tenth power is still a float64; ours
_SMALLEST_NUMBER, _LARGEST_NUMBER = 1e-30, 1e30
# whole numbers that TOML promises (toml.io, v1.0.0, "Integer"), and that any program reads as numbers
_LARGEST_INTEGER = 2**63


# how JSON writes halves of characters beyond 16 bits (RFC 8259, section 8.2), of which pairs are right
_HALF_CHARACTER = re.compile(r"\\u[dD][89a-fA-F]")


def read_bounded(path: Path, limit: int = _LARGEST_FILE) -> bytes:
    """Return the bytes of a file, or of a pipe; one without a writer is empty.

    Raises:
        OSError: it cannot be read.
        ValueError: it holds more than `limit` bytes; no more than these are read.
    """
    with open(path, "rb", opener=open_without_waiting) as file:
        size = file.seek(0, 2) if file.seekable() else 0
        file.seek(0) if size else None
        content = file.read(limit + 1) if size <= limit else b""
    if max(size, len(content)) > limit:
        raise ValueError(f"it is larger than {limit >> 20} MiB, which no such file is")
    return content


def read_table_text(path: Path) -> str:
    """Return the text of a file of tables, without the mark that some editors put first; errors as `read_bounded`.

    Raises:
        ValueError: it is not UTF-8 text.
    """
    try:
        return read_bounded(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("it is not UTF-8 text; save it as UTF-8") from None


def parse_toml(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text.

    Raises:
        ValueError: no TOML, nested too deep, or a whole number beyond 64 bits; the text says which.
    """
    try:
        table = tomllib.loads(text)
        for _ in _numbers(table):
            pass
    except RecursionError:
        raise ValueError("its tables are nested too deep") from None
    return table


def parse_json(text: str) -> Any:
    """Return the value of a JSON text.

    Raises:
        ValueError: no JSON, nested too deep, NaN, infinity, a whole number beyond 64 bits, or half of a character; the
            text says which.
    """
    try:
        value = json.loads(text, parse_int=_whole_number, parse_float=_finite_number, parse_constant=_finite_number)
        if _HALF_CHARACTER.search(text):
            json.dumps(value, ensure_ascii=False).encode()
    except RecursionError:
        raise ValueError("its tables are nested too deep") from None
    except UnicodeEncodeError:
        raise ValueError("it holds half of a character, which no text is") from None
    return value


def refuse_absurd_numbers(table: Mapping[str, Any], where: str) -> None:
    """Refuse tables with a number that no quantity of a ship has in any unit; where: names the file.

    Raises:
        InputError: there is one; its key is named.
    """
    for key, number in _numbers(table):
        if math.isfinite(number) and number and not _SMALLEST_NUMBER <= abs(number) <= _LARGEST_NUMBER:
            raise InputError(f"{where}: {key} = {number:g} is no size that a quantity of a ship can have; correct it")


def _numbers(value: object, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield every number of nested tables with its key."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _numbers(inner, f"{key}.{name}" if key else str(name))
    elif isinstance(value, list):
        for index, inner in enumerate(value, 1):
            yield from _numbers(inner, f"{key}[{index}]")
    elif isinstance(value, float):
        yield key, value
    elif isinstance(value, int):
        yield key, float(_within_64_bits(value))


def _whole_number(text: str) -> int:
    return _within_64_bits(int(text))


def _within_64_bits(number: int) -> int:
    if abs(number) > _LARGEST_INTEGER:
        raise ValueError("it holds a whole number beyond 64 bits")
    return number


def _finite_number(text: str) -> float:
    if not math.isfinite(number := float(text)):
        raise ValueError(f"it holds {text[:20]}, which is no finite number")
    return number
