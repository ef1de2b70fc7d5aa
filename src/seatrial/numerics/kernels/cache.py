"""Where compiled code is kept: a folder tested for writing, otherwise a temporary one."""

import os
import tempfile
from functools import cache
from pathlib import Path

import platformdirs


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder):
            return True
    except OSError:
        return False


@cache
def cache_folder() -> Path:
    """The folder of `SEATRIAL_CACHE`, or the user's cache folder, or a temporary one if neither can be written."""
    wanted = os.environ.get("SEATRIAL_CACHE")
    folder = Path(wanted) if wanted else Path(platformdirs.user_cache_dir("seatrial"))
    return folder if _writable(folder) else Path(tempfile.mkdtemp(prefix="seatrial-"))
