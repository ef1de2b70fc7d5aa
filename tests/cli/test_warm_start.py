"""A process that finds everything in the compile cache imports no library that it has no use for."""

import json
import os
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
heavy = ("sympy", "scipy.signal", "scipy.stats", "scipy.optimize", "sklearn", "pandas", "numba", "scipy")
print(json.dumps([name for name in heavy if name in sys.modules]))
"""


def heavy_imports(*command: str) -> list[str]:
    """Which of the libraries that take long to import a command imports once everything is in the cache."""
    heavy = libraries_imported(*command)
    return libraries_imported(*command) if "sympy" in heavy else heavy


def libraries_imported(*command: str) -> list[str]:
    done = subprocess.run([sys.executable, "-c", PROGRAM, *command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def fit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fit")
    assert heavy_imports("identify", f"{EXAMPLES}/waterjet.toml", "--out", str(folder)) == ["numba", "scipy"]
    return folder


def test_check() -> None:
    assert heavy_imports("check", f"{EXAMPLES}/waterjet.toml") == []


def test_simulate(fit: Path, tmp_path: Path) -> None:
    options = ("--manoeuvre", "zigzag:20/20", "--set", "v_j=1.866", "--out", f"{tmp_path}/zigzag.csv")
    assert heavy_imports("simulate", f"{fit}/model.toml", *options) == ["scipy.optimize", "numba", "scipy"]


def test_report(fit: Path) -> None:
    assert heavy_imports("report", str(fit)) == ["numba", "scipy"]


@pytest.mark.long
def test_tune(fit: Path, tmp_path: Path) -> None:
    options = ("--from", f"{fit}/model.toml", "--out", str(tmp_path))
    imported = heavy_imports("tune", f"{EXAMPLES}/waterjet_autopilot.toml", *options)
    assert not {"sympy", "scipy.signal", "scipy.stats", "sklearn", "pandas"} & {*imported}


def test_linear_algebra_of_a_command_has_one_thread() -> None:
    program = (
        "import os, sys; from seatrial.cli import main; assert 'numpy' not in sys.modules\n"
        "sys.argv = ['seatrial', '--version']\ntry:\n    main()\nexcept SystemExit:\n    pass\n"
        "print(os.environ['OPENBLAS_NUM_THREADS'])"
    )
    environment = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment)
    assert done.stdout.split()[-1] == "1", done.stderr
