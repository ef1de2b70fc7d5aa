"""Files and folders written whole or not at all: beside the target, through to the disk, then put in its place."""

import os
import secrets
import shutil
import tempfile
from collections.abc import Collection, Iterator, Mapping, Set
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path

from seatrial.core.values.errors import InputError
from seatrial.numerics.platform import (
    exchange_folders,
    flush_folder_to_disk,
    flush_to_disk,
    held_lock,
    replace_file,
    write_to_device,
)

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
