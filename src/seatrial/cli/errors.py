"""What a command says of an exception; the traceback of one that is not the input's goes to a file."""

import errno
import hashlib
import platform
import sys
import tempfile
import traceback
from importlib.metadata import version
from pathlib import Path

import platformdirs

from seatrial import __version__
from seatrial.core.values import InputError
from seatrial.core.values.files import write_atomically

LIBRARIES = ("numpy", "scipy", "numba", "pandas", "pydantic", "typer")
# of a stream: no space, beyond the user's quota, defective; writing a file has a sentence of its own
_DISK_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EIO)
NAME_LENGTH = 12  # hexadecimal digits of a traceback's digest in its file's name: chosen, no two alike in practice


def is_of_input(error: Exception) -> bool:
    """Return whether what failed is the user's to correct: the input, or a full disk where the output goes."""
    return isinstance(error, InputError) or (
        isinstance(error, OSError) and error.filename is None and error.errno in _DISK_ERRORS
    )


def error_message(error: Exception) -> str:
    """Return one line: the sentence of an `InputError`; else what failed and the file to send to the developers."""
    if isinstance(error, InputError):
        return " ".join(str(error).split())
    if is_of_input(error):
        return f"what it prints cannot be written ({error.strerror}); make room, or print elsewhere"  # type: ignore[attr-defined]
    if isinstance(error, MemoryError):
        reason = "the memory of this computer does not suffice"
    else:
        reason = f"an error of the program, not of your input ({type(error).__name__})"
    return f"{reason}; nothing was written by halves. Please send the file {_written_report(error)}"


def _written_report(error: Exception) -> Path:
    """Write traceback, command line and versions to a file of the user's log folder, or of the temporary one."""
    trace = "".join(traceback.format_exception(error))
    facts = [f"seatrial {__version__}", *(f"{name} {version(name)}" for name in LIBRARIES)]
    text = "\n".join(
        [f"command: {sys.argv}", f"{platform.platform()}, Python {platform.python_version()}", *facts, trace]
    )
    name = f"error-{hashlib.sha256(trace.encode(errors='replace')).hexdigest()[:NAME_LENGTH]}.txt"
    try:
        path = platformdirs.user_log_path("seatrial") / name
        write_atomically(path, text.encode(errors="replace"))
    except InputError:
        path = Path(tempfile.gettempdir()) / f"seatrial-{name}"
        write_atomically(path, text.encode(errors="replace"))
    return path
