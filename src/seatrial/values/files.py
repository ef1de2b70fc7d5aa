"""Files written whole or not at all."""

import os
import tempfile
from pathlib import Path

from seatrial.values.errors import InputError


def write_whole(path: Path, content: bytes) -> None:
    """Write beside the target, then rename.

    Raises:
        InputError: the place cannot be written.
    """
    temporary = ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".writing-")
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except OSError as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        raise InputError(f"'{path}' cannot be written ({error.strerror}); choose another place") from None


def writable_folder(folder: Path) -> Path:
    """The folder, made if absent, after a test of writing to it: before the work, not after.

    Raises:
        InputError: it cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".writing-"):
            return folder
    except OSError as error:
        raise InputError(f"folder '{folder}' cannot be written ({error.strerror}); choose another with --out") from None
