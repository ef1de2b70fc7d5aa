"""A shortcut on the desktop that opens a folder in the workspace."""

import os
import sys
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.core.values.files import is_folder, write_atomically

_LINUX = """[Desktop Entry]
Type=Application
Name=seatrial {name}
Exec="{python}" -m seatrial open "{folder}"
Terminal=true
"""
_MAC = '#!/bin/sh\nexec "{python}" -m seatrial open "{folder}"\n'
_WINDOWS = '@"{python}" -m seatrial open "{folder}"\r\n'


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
    if any(letter in str(folder) for letter in '"\n\r%$`\\' if os.name == "posix"):
        raise InputError(f"'{folder}' has letters that a shortcut cannot hold; rename the folder")
    kinds = {"win32": (_WINDOWS, ".bat"), "darwin": (_MAC, ".command")}
    template, suffix = kinds.get(sys.platform, (_LINUX, ".desktop"))
    path = place / f"seatrial {folder.name}{suffix}"
    text = template.format(name=folder.name, python=sys.executable, folder=folder)
    write_atomically(path, text.encode())
    if os.name == "posix":
        path.chmod(0o755)  # the user may change it, all may run it
    return path
