"""The folder that was opened: which trial file it holds, its logs and results; nothing outside is named by a page."""

import os
import re
from collections.abc import AsyncIterator
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.core.values.files import is_file, is_folder, is_present, parse_toml, read_table_text
from seatrial.data.read.registry import FORMATS
from seatrial.numerics.platform import replace_file

TRIAL = "trial.toml"
"""The trial file of a folder of logs; that of `seatrial init`."""
_RESULT = "result.json"  # of a folder of `identify`, whose tables are no logs
_HIDDEN = re.compile(r"^\.")
_UNSAFE = re.compile(r"[\x00-\x1f/\\:*?\"<>|]")
_MOST_LISTED = 2000  # files of a folder that are listed; chosen


def opened_trial(path: Path) -> tuple[Path, list[Path]]:
    """Return the trial file that a path opens, which need not exist yet, and the logs that are named.

    Args:
        path: a trial file, a log, or a folder with either.

    Raises:
        InputError: there is nothing of that name.
    """
    path = path.resolve()
    if is_folder(path):
        trials = [file for file in sorted(path.glob("*.toml")) if is_trial(file)]
        return next((file for file in trials if file.name == TRIAL), trials[0] if trials else path / TRIAL), []
    if not is_present(path):
        raise InputError(f"there is no '{path}'; name a trial file, a log, or a folder with logs")
    return (path, []) if path.suffix.lower() == ".toml" else (path.parent / TRIAL, [path])


def _tables(path: Path) -> set[str]:
    """The names of a TOML file's tables; none of one that cannot be read."""
    try:
        return set(parse_toml(read_table_text(path)))
    except (OSError, ValueError):
        return set()


def is_trial(path: Path) -> bool:
    """Return whether a TOML file has runs, a stream or a manoeuvre to design: no loop file, no model file."""
    return bool(_tables(path) & {"records", "follow", "design"}) and "plant" not in _tables(path)


def is_loop(path: Path) -> bool:
    """Return whether a TOML file describes a loop that is tuned."""
    return {"plant", "controller"} <= _tables(path)


class OpenedFolder:
    """A folder and what lies below it."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()

    def file(self, name: str) -> Path:
        """Return the file of that name below the folder.

        Raises:
            InputError: it lies elsewhere, or there is none.
        """
        path = self.place(name)
        if not is_file(path):
            raise InputError(f"there is no file '{name}' in the folder that was opened")
        return path

    def place(self, name: str) -> Path:
        """Return a place below the folder, links followed.

        Raises:
            InputError: it lies elsewhere.
        """
        try:
            path = (self.root / name).resolve()
        except (OSError, ValueError, RuntimeError):
            raise InputError("that is no name of a file") from None
        if not path.is_relative_to(self.root):
            raise InputError(f"'{name}' lies outside the folder that was opened; open the folder that holds it")
        return path

    @property
    def logs(self) -> list[Path]:
        """The files of known formats below the folder, but for hidden ones and those of result folders."""
        suffixes = {suffix for kind in FORMATS.values() for suffix in kind.suffixes}
        files: list[Path] = []
        for place, folders, names in os.walk(self.root):
            folders[:] = sorted(name for name in folders if not _HIDDEN.match(name))
            if _RESULT in names:
                folders.clear()
                continue
            for name in sorted(names):
                suffix = Path(name.removesuffix(".gz")).suffix.lower()
                if suffix in suffixes and not _HIDDEN.match(name) and is_file(Path(place, name)):
                    files.append(Path(place, name))
            if len(files) >= _MOST_LISTED:
                break
        return files[:_MOST_LISTED]

    @property
    def loops(self) -> list[Path]:
        """The loop files beside the trial file."""
        return [path for path in sorted(self.root.glob("*.toml")) if is_loop(path)]

    async def receive(self, name: str, parts: AsyncIterator[bytes]) -> Path:
        """Write an uploaded file whole into the folder, or not at all, and return its path.

        Raises:
            InputError: a name that is none, or one that a file has already.
        """
        if not name or _UNSAFE.search(name) or _HIDDEN.match(name):
            raise InputError(f"'{name}' is no name for a file here; rename it")
        if Path(name).suffix.lower() in (".toml", ".html"):
            raise InputError(f"'{name}' is no log; a trial file is opened with 'seatrial open'")
        target = self.place(name)
        if is_present(target):
            raise InputError(f"the folder has a file '{name}' already; rename the one that you drop")
        draft = target.with_name(f".{name}.part")
        try:
            with draft.open("xb") as file:
                async for part in parts:
                    file.write(part)
            replace_file(draft, target)
        except FileExistsError:
            raise InputError(f"'{name}' is being received already; wait for it") from None
        except OSError as error:
            raise InputError(f"'{name}' cannot be written ({error.strerror}); check the disk") from None
        finally:
            draft.unlink(missing_ok=True)
        return target
