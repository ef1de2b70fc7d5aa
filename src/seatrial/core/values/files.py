"""Files written whole or not at all."""

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from seatrial.core.values.errors import InputError
from seatrial.numerics.platform import replace_file


def write_atomically(path: Path, content: bytes) -> None:
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
        replace_file(Path(temporary), path)
    except OSError as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        raise InputError(f"'{path}' cannot be written ({error.strerror}); choose another place") from None


def write_files_atomically(folder: Path, contents: Mapping[str, bytes]) -> Path:
    """Write files of a folder beside it first, then move them in; others in it are left alone. Returns the folder.

    Raises:
        InputError: the folder cannot be written.
    """
    folder = writable_folder(folder)
    folder.mkdir(parents=True, exist_ok=True)
    staging = Path(tempfile.mkdtemp(dir=folder, prefix=".writing-"))
    try:
        for name, content in contents.items():
            (staging / name).write_bytes(content)
        for name in contents:
            replace_file(staging / name, folder / name)
    except OSError as error:
        raise InputError(f"folder '{folder}' cannot be written ({error.strerror}); choose another place") from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    return folder


def writable_folder(folder: Path) -> Path:
    """The folder, after a test of writing to it: before the work, not after. One that was absent is absent again.

    Raises:
        InputError: it cannot be made or written.
    """
    absent = [place for place in (folder, *folder.parents) if not place.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".writing-"):
            pass
        for place in absent:
            place.rmdir()
    except OSError as error:
        raise InputError(f"folder '{folder}' cannot be written ({error.strerror}); choose another place") from None
    return folder
