"""The architecture page shows the imports as they are."""

import subprocess
import sys
from pathlib import Path


def test_the_picture_and_the_table_are_current(repository: Path) -> None:
    command = [sys.executable, "docs/draw_architecture.py", "--check"]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_the_page_is_one_screen_and_names_every_subpackage(repository: Path) -> None:
    page = (repository / "docs" / "architecture.md").read_text(encoding="utf-8")
    assert len(page.splitlines()) <= 90
    source = repository / "src" / "seatrial"
    for folder in (p for p in source.iterdir() if p.is_dir() and (p / "__init__.py").exists()):
        assert f"`{folder.name}" in page
