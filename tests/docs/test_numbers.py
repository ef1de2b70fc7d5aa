"""The page of numbers and the README's table are what the benchmarks recorded."""

import json
import subprocess
import sys
from pathlib import Path

from run import BENCHMARKS


def test_page_and_readme_are_current(repository: Path) -> None:
    command = [sys.executable, "docs/write_numbers.py", "--check"]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_readme_has_at_most_eight_numbers_each_with_its_command(repository: Path) -> None:
    readme = (repository / "README.md").read_text(encoding="utf-8")
    rows = [line for line in readme.split("## Numbers")[1].splitlines() if line.startswith("| ")][1:]
    assert 0 < len(rows) <= 8
    assert all("`python benchmarks/run.py " in row for row in rows)


def test_every_recorded_table_belongs_to_a_benchmark(repository: Path) -> None:
    recorded = json.loads((repository / "docs" / "numbers.json").read_text(encoding="utf-8"))
    assert set(recorded) <= set(BENCHMARKS)
    assert all(entry["commit"] and entry["lines"] for entry in recorded.values())


def test_the_page_of_longer_runs_is_current(repository: Path) -> None:
    command = [sys.executable, "docs/write_measured.py", "--check"]
    assert subprocess.run(command, cwd=repository, check=False).returncode == 0
