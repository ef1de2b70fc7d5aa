"""The list of files in docs/architecture.md is that of the folders."""

import re
from pathlib import Path


def test_every_file_is_drawn_where_it_stands(repository: Path) -> None:
    text = (repository / "docs" / "architecture.md").read_text(encoding="utf-8")
    listed = text.split("## The files")[1].split("## ")[0]
    rows = re.findall(r"^\| `([a-z0-9_/]+)` \| (.+) \|$", listed, re.MULTILINE)
    drawn = {room: set(re.findall(r"`([a-z0-9_]+)`", files)) for room, files in rows}
    source = repository / "src" / "seatrial"
    rooms = [path.parent for path in source.rglob("__init__.py") if path.parent != source]
    stands = {room.relative_to(source).as_posix(): _names(room) for room in rooms}
    assert drawn == stands


def _names(room: Path) -> set[str]:
    files = {path.stem for path in room.glob("*.py") if path.stem != "__init__"}
    return files | {path.parent.name for path in room.glob("*/__init__.py")}
