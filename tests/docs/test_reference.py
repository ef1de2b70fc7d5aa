"""Command line and keys of the files are what the code says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

MOST_KEYS = 244  # of a trial file, a key of two tables counted twice; two are of published methods; chosen
MOST_LOOP_KEYS = 156  # of a loop file, counted the same way; those there are


def test_command_line_and_keys_are_current(repository: Path) -> None:
    command = [sys.executable, "docs/write_reference.py", "--check"]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(("page", "most"), [("trial-keys", MOST_KEYS), ("loop-keys", MOST_LOOP_KEYS)])
def test_every_key_of_a_file_has_its_meaning_beside_it(repository: Path, page: str, most: int) -> None:
    keys = (repository / "docs" / f"{page}.md").read_text(encoding="utf-8")
    tables = re.findall(r"^\| key \|(.*)\n\|[-|]+\n((?:\|.*\n)+)", keys, re.MULTILINE)
    rows = [(heads, row.split(" | ")) for heads, table in tables for row in table.splitlines()]
    assert len({row[0] for _, row in rows}) > 100 and len(rows) <= most
    assert [row for heads, row in rows if "meaning" not in heads or not row[1].strip()] == []
