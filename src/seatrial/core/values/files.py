"""Files and folders written whole or not at all: beside the target, through to the disk, then put in its place."""

import os
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from seatrial.core.values.errors import InputError
from seatrial.numerics.platform import exchange_folders, flush_folder_to_disk, flush_to_disk, held_lock, replace_file

_DRAFT = ".writing-"  # begins the names of files and folders that are being written
_DRAFT_BYTES = 6  # of the random part of such a name: chosen, 2**48 names


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file beside the target, then rename it; a symbolic link is written through.

    Raises:
        InputError: the place cannot be written.
    """
    target = path.resolve()
    draft = target.with_name(_draft_name())
    with _sentence(f"'{path}'"):
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            _write(draft, content)
            replace_file(draft, target)
        finally:
            draft.unlink(missing_ok=True)


def write_files_atomically(folder: Path, contents: Mapping[str, bytes]) -> Path:
    """Write files of a folder, all or none, and return the folder; other files in it stay.

    The folder is built anew beside the old one and the two are exchanged in one step, so that a process killed at any
    moment leaves the old files or the new ones. Only where that is impossible, because the folder holds folders of the
    user, is the working directory, or lies on a file system without exchange or hard links, are files renamed into it
    one by one.

    Raises:
        InputError: the folder cannot be written.
    """
    target = folder.resolve()
    with _sentence(f"folder '{folder}'"), _new_parents(target.parent):
        _remove_abandoned_drafts(target)
        draft = target.with_name(f".{target.name}{_draft_name()}")
        draft.mkdir()
        try:
            with held_lock(draft):
                for name, content in contents.items():
                    _write(draft / name, content)
                _put_in_place(draft, target, contents)
        finally:
            shutil.rmtree(draft, ignore_errors=True)
    return folder


def writable_folder(folder: Path) -> Path:
    """The folder, after a test of writing to it: before the work, not after. One that was absent is absent again.

    Raises:
        InputError: it cannot be made or written.
    """
    absent = _absent(folder)
    with _sentence(f"folder '{folder}'"):
        folder.mkdir(parents=True, exist_ok=True)
        draft = folder / _draft_name()
        _write(draft, b"")
        draft.unlink()
        for place in absent:
            place.rmdir()
    return folder


def _draft_name() -> str:
    return _DRAFT + secrets.token_hex(_DRAFT_BYTES)


def _write(path: Path, content: bytes) -> None:
    with path.open("xb") as file:  # made with the permissions that the user's umask gives
        file.write(content)
        file.flush()
        flush_to_disk(file.fileno())


def _put_in_place(draft: Path, target: Path, contents: Mapping[str, bytes]) -> None:
    if not target.exists():
        flush_folder_to_disk(draft)
        replace_file(draft, target)
    elif not (_adopt_others(draft, target, contents) and exchange_folders(draft, target)):
        for name in contents:
            replace_file(draft / name, target / name)
    flush_folder_to_disk(target.parent)


def _adopt_others(draft: Path, target: Path, contents: Mapping[str, bytes]) -> bool:
    """Link the user's other files of a folder into the draft of its successor; False where that cannot be done."""
    if target == Path.cwd():
        return False
    shutil.copymode(target, draft)
    try:
        for file in target.iterdir():
            if file.name not in contents:
                os.link(file, draft / file.name, follow_symlinks=False)
    except OSError:  # a folder, another device, or a system without links
        return False
    flush_folder_to_disk(draft)
    return True


def _remove_abandoned_drafts(target: Path) -> None:
    """Remove drafts of a folder whose process has ended without doing so."""
    for draft in target.parent.glob(f".{_literal(target.name)}{_DRAFT}*"):
        with held_lock(draft) as locked:
            if locked:
                shutil.rmtree(draft, ignore_errors=True)


def _literal(name: str) -> str:
    """The pattern that a name alone matches."""
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)


def _absent(folder: Path) -> list[Path]:
    return [place for place in (folder, *folder.parents) if not place.exists()]


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
    except OSError as error:
        raise InputError(f"{place} cannot be written ({error.strerror}); choose another place") from None
