"""The compile cache: entries that are verified before anything of them is used, and made again where they fail.

An entry is one file. Its first line holds the SHA-256 of its name and content, so a damaged, truncated or exchanged
entry is recognised before Numba, the interpreter or a parser sees a byte of it. Only regular files that belong to the
user or to root, and that nobody else may write, are read. Whatever is wrong is logged in one line and the entry
discarded; nothing here raises an error, for a cache must never stop a command.
"""

import atexit
import contextlib
import errno
import hashlib
import logging
import os
import shutil
import stat
import tempfile
from functools import cache
from pathlib import Path

import platformdirs

from seatrial.numerics.platform import distrust, flush_to_disk, open_regular, replace_file

_log = logging.getLogger("seatrial")
_MARK = b"# seatrial cache entry, format 1, sha256 "
_FOLDER = "entries-1"


class _UnusableError(Exception):
    """An entry or folder that must not be used; the text says why."""


def _demand_trusted(facts: os.stat_result) -> None:
    if reason := distrust(facts):
        raise _UnusableError(reason)


def _reason(error: Exception) -> str:
    if isinstance(error, OSError):
        return "it is a symbolic link" if error.errno == errno.ELOOP else error.strerror or type(error).__name__
    return str(error)


@cache
def _folders() -> tuple[Path, ...]:
    """Return the folders that entries are read from; the first is written to."""
    chosen = os.environ.get("SEATRIAL_CACHE")
    folder = (Path(chosen) if chosen else Path(platformdirs.user_cache_dir("seatrial"))) / _FOLDER
    readable = False
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)  # read and written by its owner alone
        _demand_trusted(folder.stat())
        readable = True
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".writing-"):
            return (folder,)
    except (OSError, _UnusableError) as error:
        reason = _reason(error)
    parent = Path(tempfile.mkdtemp(prefix="seatrial-"))
    atexit.register(shutil.rmtree, parent, ignore_errors=True)
    temporary = parent / _FOLDER
    temporary.mkdir(mode=0o700)  # read and written by its owner alone
    _log.warning(
        "the compile cache '%s' cannot be written (%s), so this run compiles into a temporary folder; make it writable "
        "for you alone or set SEATRIAL_CACHE to another folder", folder, reason,
    )  # fmt: skip
    return (temporary, folder) if readable else (temporary,)


def cache_folder() -> Path:
    """Return the folder that entries are written to.

    It lies in the folder named by `SEATRIAL_CACHE`, otherwise in the user's cache folder. Where that cannot be written
    or others may write it, it is a temporary one, removed at the end of the process.
    """
    return _folders()[0]


def entry_path(name: str) -> Path:
    """Return where the entry of that name is written."""
    return cache_folder() / name


def _digest(name: str, content: bytes) -> bytes:
    return hashlib.sha256(name.encode() + b"\0" + content).hexdigest().encode()


def _verified(path: Path) -> bytes:
    handle = open_regular(path)
    try:
        facts = os.fstat(handle)
        if not stat.S_ISREG(facts.st_mode):
            raise _UnusableError("it is not a regular file")
        _demand_trusted(facts)
        with open(handle, "rb", closefd=False) as file:
            first, content = file.readline(), file.read()
    finally:
        os.close(handle)
    if first != _MARK + _digest(path.name, content) + b"\n":
        raise _UnusableError("its content is not what was written")
    return content


def read_entry(name: str) -> bytes | None:
    """Return the content of an entry, or None where there is none; an unusable one is discarded and logged."""
    for folder in _folders():
        try:
            return _verified(folder / name)
        except FileNotFoundError:
            continue
        except (OSError, _UnusableError) as error:
            _discard(folder / name, _reason(error))
    return None


def discard_entry(name: str, reason: str) -> None:
    """Remove an entry that was as written and could not be used all the same, and log it."""
    _discard(entry_path(name), reason)


def _discard(path: Path, reason: str) -> None:
    _log.warning("compile cache: '%s' is discarded and made again (%s)", path, reason)
    with contextlib.suppress(OSError):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink()


def write_entry(name: str, content: bytes) -> None:
    """Write an entry: a temporary file, flushed to the disk, then one rename; a failure is logged and ignored."""
    path, temporary = entry_path(name), ""
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".writing-")
        with os.fdopen(handle, "wb") as file:
            file.write(_MARK + _digest(name, content) + b"\n" + content)
            file.flush()
            flush_to_disk(file.fileno())
        replace_file(Path(temporary), path)
    except OSError as error:
        _log.warning("compile cache: '%s' is not kept (%s)", path, _reason(error))
        if temporary:
            Path(temporary).unlink(missing_ok=True)


@cache
def source_digest(place: Path) -> bytes:
    """Return the SHA-256 of a Python file, or of all of them in a folder."""
    files = sorted(place.glob("*.py")) if place.is_dir() else [place]
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).digest()
