"""What differs between operating systems: processors, file locks, renaming, writing through to disk, signals, waiting.

Nothing else in the package asks which system it runs on. Where a system lacks something the function says what happens
instead.
"""

import ctypes
import os
import select
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import RawIOBase
from pathlib import Path

_SYSTEM = os.name
_RETRIES_REPLACING = _SYSTEM == "nt"
_RUN_BY_ALL = stat.S_IRWXU | stat.S_IRGRP | stat.S_IXGRP | stat.S_IROTH | stat.S_IXOTH
# Windows refuses to replace a file that a virus scanner or an indexer has open for a moment; s between attempts, and
# how many: half a second in all, as long as such programs hold a small file
_REPLACE_PAUSE_S, _REPLACE_ATTEMPTS = 0.05, 10
# offset of the byte that stands for a whole file where only ranges can be locked: beyond every file that is locked, and
# within the 31 bits that msvcrt takes
_LOCKED_BYTE = 2**31 - 2

# renameat2(2): paths relative to the working directory (AT_FDCWD); RENAME_EXCHANGE, which macOS calls RENAME_SWAP
_AT_WORKING_DIRECTORY, _EXCHANGE = -100, 2


_BLOCK = 512
"""Bytes in the unit of st_blocks (POSIX, sys/stat.h on all systems that Python supports)."""


def system_name() -> str:
    """Return the system as FMI 2.0 names it (section 2.3): linux, darwin, win; elsewhere as Python does."""
    return {"win32": "win"}.get(sys.platform, sys.platform)


def library_suffix() -> str:
    """Return how names of shared libraries end."""
    return {"darwin": ".dylib", "win32": ".dll"}.get(sys.platform, ".so")


def click_suffix() -> str:
    """Return how files end that the desktop runs when they are clicked."""
    return {"darwin": ".command", "win32": ".bat"}.get(sys.platform, ".desktop")


def make_executable(path: Path) -> None:
    """Let all run a file and its owner change it, where the system asks for it."""
    if os.name == "posix":
        path.chmod(_RUN_BY_ALL)


def start_in_background(command: Sequence[str], environment: Mapping[str, str], niceness: int) -> subprocess.Popen[str]:
    """Start a command whose outputs are read, in a session of its own and at a lower priority where there are any.

    niceness: of the process, 19 at most (POSIX).
    """
    is_posix = os.name == "posix"
    process = subprocess.Popen(
        list(command), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        errors="replace", env=dict(environment), start_new_session=is_posix,
    )  # fmt: skip
    if is_posix:
        os.setpriority(os.PRIO_PROCESS, process.pid, niceness)
    return process


def usable_cores() -> int:
    """Return the number of processor cores this process may use; all of them where the system has no affinities."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def lock_exclusively(file: RawIOBase) -> bool:
    """Lock an open file for this process and return whether that succeeded; the lock ends when the file is closed.

    True as well, and without a lock, where the system has none.
    """
    try:
        import fcntl
    except ImportError:
        return _lock_first_byte(file)
    try:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _lock_first_byte(file: RawIOBase) -> bool:
    """Lock one byte, as Windows does; it lies far beyond any end, so that others can still read the file."""
    try:
        import msvcrt
    except ImportError:
        return True
    position = file.tell()
    file.seek(_LOCKED_BYTE)
    try:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # pyright: ignore[reportAttributeAccessIssue]
    except OSError:
        return False
    finally:
        file.seek(position)
    return True


def replace_file(source: Path, target: Path) -> None:
    """Rename a file to `target`, which is replaced in one step if it exists; tried for half a second where it is open.

    Raises:
        OSError: the system refuses.
    """
    for _ in range(_REPLACE_ATTEMPTS - 1):
        try:
            source.replace(target)
        except PermissionError:
            if not _RETRIES_REPLACING:
                raise
            time.sleep(_REPLACE_PAUSE_S)
        else:
            return
    source.replace(target)


def flush_to_disk(descriptor: int) -> None:
    """Wait until what was written to an open file is on the disk.

    Raises:
        OSError: the disk is full or has failed.
    """
    os.fsync(descriptor)


def flush_folder_to_disk(folder: Path) -> None:
    """Wait until the names in a folder are on the disk; nothing where folders cannot be opened (Windows).

    Raises:
        OSError: the disk has failed.
    """
    if _SYSTEM == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def exchange_folders(one: Path, other: Path) -> bool:
    """Exchange the names of two folders in one step and return whether the system could (Linux, macOS)."""
    if _SYSTEM != "posix":
        return False
    library = ctypes.CDLL(None)
    paths = os.fsencode(one), os.fsencode(other)
    if hasattr(library, "renameat2"):  # Linux, renameat2(2)
        return library.renameat2(_AT_WORKING_DIRECTORY, paths[0], _AT_WORKING_DIRECTORY, paths[1], _EXCHANGE) == 0
    if hasattr(library, "renamex_np"):  # macOS, renamex_np(2)
        return library.renamex_np(*paths, _EXCHANGE) == 0
    return False


@contextmanager
def held_lock(folder: Path) -> Iterator[bool]:
    """Lock a folder for this process while the body runs and give whether that succeeded.

    False as well where folders cannot be locked (Windows).
    """
    try:
        import fcntl

        descriptor = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):
        yield False
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        locked = True
    except OSError:
        locked = False
    try:
        yield locked
    finally:
        os.close(descriptor)


def open_regular(path: Path) -> int:
    """Open a file for reading and return its descriptor: not through a symbolic link, and without waiting for a pipe.

    Where the system has no such flags a link is followed.

    Raises:
        OSError: there is no such file, it is a symbolic link (errno ELOOP), or it may not be read.
    """
    flags = ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY")
    return os.open(path, sum((getattr(os, flag, 0) for flag in flags), os.O_RDONLY))


def write_to_device(path: Path, content: bytes) -> None:
    """Write to a device, or to a pipe, which must have a reader already where the system can see that.

    Raises:
        OSError: it cannot be written, or nobody reads the pipe (errno ENXIO).
    """
    with os.fdopen(open_without_waiting(str(path), os.O_WRONLY), "wb") as file:
        file.write(content)


def open_without_waiting(path: str, flags: int) -> int:
    """Open a file as `open` does with `opener`, but do not wait until somebody writes to a pipe.

    Raises:
        OSError: it cannot be opened.
    """
    descriptor = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    if hasattr(os, "O_NONBLOCK"):
        os.set_blocking(descriptor, True)
    return descriptor


def written_size(facts: os.stat_result) -> int:
    """Return how many bytes of a file were ever written; its size where the system does not say.

    A copy that was broken off, or a file made longer by one call, has holes, which read as zeros and take no space.
    """
    blocks = getattr(facts, "st_blocks", None)
    return facts.st_size if blocks is None else min(facts.st_size, blocks * _BLOCK)


def distrust(facts: os.stat_result) -> str:
    """Return why a file or folder is not this user's own: another owner than the user and root, or others may write it.

    Empty where it is, or where the system has no such owners and modes.
    """
    if not hasattr(os, "getuid"):
        return ""
    if facts.st_uid not in {0, os.getuid()}:
        return "it belongs to another user"
    return "other users may write it" if facts.st_mode & (stat.S_IWGRP | stat.S_IWOTH) else ""


def stop_signals() -> tuple[signal.Signals, ...]:
    """Return the signals by which a user or the system ends a process politely."""
    names = ("SIGINT", "SIGTERM", "SIGBREAK")
    return tuple(signal.Signals[name] for name in names if name in signal.Signals.__members__)


def has_input(descriptor: int, seconds: float) -> bool:
    """Return whether an open file has something to read (or has ended), waiting up to `seconds` s for it.

    True at once where the system cannot wait for this kind of file (pipes on Windows): the read then waits.
    """
    try:
        return bool(select.select([descriptor], [], [], max(seconds, 0.0))[0])
    except OSError:
        return True


def reuses_addresses_safely() -> bool:
    """Return whether a port just given up may be bound again; on Windows that would let two programs share it."""
    return _SYSTEM != "nt"


def limit_resources(memory_bytes: int, cpu_s: int) -> None:
    """Limit the memory and the CPU time of this process; beyond them it fails to allocate, or is ended.

    Without effect where the system has no such limits.
    """
    try:
        import resource
    except ImportError:
        return
    for kind, limit in ((resource.RLIMIT_AS, memory_bytes), (resource.RLIMIT_CPU, cpu_s), (resource.RLIMIT_CORE, 0)):
        _, hard = resource.getrlimit(kind)
        wanted = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
        resource.setrlimit(kind, (wanted, hard))
