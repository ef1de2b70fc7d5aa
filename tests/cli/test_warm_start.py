"""A process that finds everything in the compile cache imports neither SymPy nor scipy.signal nor scipy.stats."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
PROGRAM = """
import json, sys
from seatrial.cli import main
sys.argv = ["seatrial", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
print(json.dumps([name for name in ("sympy", "scipy.signal", "scipy.stats", "sklearn") if name in sys.modules]))
"""


def heavy_imports(*command: str) -> list[str]:
    """Which of the libraries that take long to import the second run of a command imports."""
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", PROGRAM, *command], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def fit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fit")
    assert heavy_imports("identify", f"{EXAMPLES}/waterjet.toml", "--out", str(folder)) == []
    return folder


def test_check() -> None:
    assert heavy_imports("check", f"{EXAMPLES}/waterjet.toml") == []


def test_simulate(fit: Path, tmp_path: Path) -> None:
    options = ("--manoeuvre", "zigzag:20/20", "--set", "v_j=1.866", "--out", f"{tmp_path}/zigzag.csv")
    assert heavy_imports("simulate", f"{fit}/model.toml", *options) == []


def test_report(fit: Path) -> None:
    assert heavy_imports("report", str(fit)) == []


def test_tune(fit: Path, tmp_path: Path) -> None:
    options = ("--from", f"{fit}/model.toml", "--out", str(tmp_path))
    assert heavy_imports("tune", f"{EXAMPLES}/waterjet_autopilot.toml", *options) == []
