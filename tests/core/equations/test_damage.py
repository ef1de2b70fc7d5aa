"""Whatever happens to an entry of the compile cache: the command goes on, makes it again, and logs one line."""

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the program forks")
KINDS = ("manifest", "generated module", "machine code")
RATE = 6.0  # slope 3 times parameter 2 at x = 1


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Any]:
    environment = {**os.environ, "SEATRIAL_CACHE": str(tmp_path_factory.mktemp("cache"))}
    program = Path(__file__).parent / "damage.py"
    done = subprocess.run([sys.executable, str(program)], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_an_undamaged_cache_is_silent(answers: Mapping[str, Any]) -> None:
    assert answers["first"] == {"status": 0, "value": RATE, "log": []}


@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_entry_is_made_again_with_one_line(answers: Mapping[str, Any], kind: str) -> None:
    ways = {name: answer for name, answer in answers.items() if name.startswith(kind)}
    assert len(ways) >= 12
    for name, answer in ways.items():
        assert (answer["status"], answer.get("value")) == (0, RATE), name
        assert answer["is_whole"], name
        (line,) = answer["log"]
        assert "is discarded and made again" in line, name
