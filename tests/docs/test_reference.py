"""The page of the command line is what the commands say."""

import subprocess
import sys
from pathlib import Path


def test_the_page_of_the_command_line_is_current(repository: Path) -> None:
    command = [sys.executable, "docs/write_reference.py", "--check"]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
