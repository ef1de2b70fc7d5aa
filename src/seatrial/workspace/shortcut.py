"""A shortcut on the desktop that opens a folder in the workspace."""

import sys
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.core.values.files import is_folder, write_atomically
from seatrial.numerics.platform import click_suffix, make_executable

_LINUX = """[Desktop Entry]
Type=Application
Name=seatrial {name}
Exec="{python}" -m seatrial open "{folder}"
Terminal=true
"""
_MAC = '#!/bin/sh\nexec "{python}" -m seatrial open "{folder}"\n'
_WINDOWS = '@"{python}" -m seatrial open "{folder}"\r\n'
_UNFIT = '"\n\r%$`\\'
"""Letters of a path, with slashes, that a line of these files would take for its own."""


def write_shortcut(folder: Path, desktop: Path | None = None) -> Path:
    """Write a file on the desktop that opens a folder in the workspace when it is clicked, and return its path.

    desktop: folder of the desktop; None: that of the user.

    Raises:
        InputError: there is no desktop, or a name that cannot stand in such a file.
    """
    place = desktop or Path.home() / "Desktop"
    if not is_folder(place):
        raise InputError(f"there is no desktop '{place}'; start with 'seatrial open {folder}'")
    folder = folder.resolve()
    suffix = click_suffix()
    if any(letter in folder.as_posix() for letter in _UNFIT):
        raise InputError(f"'{folder}' has letters that a shortcut cannot hold; rename the folder")
    template = {".bat": _WINDOWS, ".command": _MAC}.get(suffix, _LINUX)
    path = place / f"seatrial {folder.name}{suffix}"
    text = template.format(name=folder.name, python=sys.executable, folder=folder)
    write_atomically(path, text.encode())
    make_executable(path)
    return path
