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


def test_every_key_of_the_trial_file_has_its_meaning_on_its_page_or_that_of_thrusters_or_beside_it(
    repository: Path,
) -> None:
    docs = repository / "docs"
    keys = (docs / "trial-keys.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \|(?: (.+?) \|(?= .* \| .*\|$))?", keys, re.MULTILINE)
    meanings = "".join((docs / name).read_text(encoding="utf-8") for name in ("trial-file.md", "thrusters.md"))
    lacking = sorted({key for key, meaning in rows if not meaning and not re.search(rf"\b{key}\b", meanings)})
    assert len({key for key, _ in rows}) > 100 and len(rows) <= MOST_KEYS
    assert sum(bool(meaning) for _, meaning in rows) > 40
    assert lacking == []
