"""Command line and keys of the trial file are what the code says."""

import re
import subprocess
import sys
from pathlib import Path

MOST_KEYS = 244  # of a trial file, a key of two tables counted twice; two are of published methods; chosen


def test_command_line_and_keys_are_current(repository: Path) -> None:
    command = [sys.executable, "docs/write_reference.py", "--check"]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_key_of_the_trial_file_has_its_meaning_on_its_page_or_that_of_thrusters(repository: Path) -> None:
    docs = repository / "docs"
    meanings = "".join((docs / name).read_text(encoding="utf-8") for name in ("trial-file.md", "thrusters.md"))
    rows = re.findall(r"^\| `(\w+)` \|", (docs / "trial-keys.md").read_text(encoding="utf-8"), re.MULTILINE)
    listed = set(rows)
    assert len(listed) > 100 and len(rows) <= MOST_KEYS
    assert sorted(key for key in listed if not re.search(rf"\b{key}\b", meanings)) == []
