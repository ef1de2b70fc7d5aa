"""Files of a campaign on a machine that does not have them: their contents travel once and lie in a folder there."""

import hashlib
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class CarriedFiles:
    """Contents of files by their path from a common folder, with forward slashes."""

    contents: Mapping[str, bytes]

    def unpack(self) -> Path:
        """Write the files to a new temporary folder, which is left to the system, and return it."""
        root = Path(tempfile.mkdtemp(prefix="seatrial-campaign-"))
        for name, content in self.contents.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        return root

    @property
    def digest(self) -> str:
        """Return the SHA-256 of names and contents."""
        total = hashlib.sha256()
        for name, content in sorted(self.contents.items()):
            total.update(f"{name} {len(content)}\n".encode() + content)
        return total.hexdigest()


def common_folder(files: Sequence[Path]) -> Path:
    """Return the folder below which all files lie."""
    return Path(os.path.commonpath([file.parent for file in files]))


def carried_files(root: Path, files: Sequence[Path]) -> CarriedFiles:
    """Read files below `root`.

    Raises:
        OSError: one cannot be read.
    """
    return CarriedFiles({file.relative_to(root).as_posix(): file.read_bytes() for file in files})
