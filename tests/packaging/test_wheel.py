"""The built wheel in an empty environment: commands run, examples are read, studies and data files are in it."""

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

from seatrial import __version__

pytestmark = pytest.mark.long
SCRIPTS = "Scripts" if os.name == "nt" else "bin"
STUDIES = """
from importlib.metadata import entry_points
print(*(point.name for point in entry_points(group="seatrial.studies") if callable(point.load())))
"""


@pytest.fixture(scope="module")
def environment(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scripts folder of an environment that holds the wheel alone; its dependencies come from this environment."""
    pytest.importorskip("hatchling", reason="building the wheel needs the extra 'dev'")
    folder = tmp_path_factory.mktemp("wheel")
    pip = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
    build = ("wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder), str(repository))
    subprocess.run([*pip, *build], check=True, capture_output=True)
    (wheel,) = folder.glob("seatrial-*.whl")
    venv.create(folder / "empty", with_pip=False)
    python = folder / "empty" / SCRIPTS / "python"
    subprocess.run([*pip, "--python", str(python), "install", "--no-deps", "--no-index", str(wheel)], check=True)
    command = [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]
    packages = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    # a path file adds the folder without running the path files in it: the editable install stays out
    Path(packages, "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return python.parent


def run(environment: Path, *command: str, folder: Path) -> str:
    """Run a command of the environment in a folder, without this checkout on its path; what it printed."""
    clean = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "SEATRIAL_DATA")}
    done = subprocess.run(
        [environment / command[0], *command[1:]], cwd=folder, env=clean, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_command_names_its_version_and_its_commands(environment: Path, tmp_path: Path) -> None:
    assert run(environment, "seatrial", "--version", folder=tmp_path).strip() == f"seatrial {__version__}"
    assert "identify" in run(environment, "seatrial", "--help", folder=tmp_path)


def test_an_example_copied_elsewhere_is_checked(environment: Path, repository: Path, tmp_path: Path) -> None:
    shutil.copy(repository / "examples" / "waterjet.toml", tmp_path)
    shutil.copytree(repository / "examples" / "waterjet", tmp_path / "waterjet")
    assert "no errors, no warnings, 3 notes" in run(environment, "seatrial", "check", "waterjet.toml", folder=tmp_path)


def test_the_studies_are_found_and_import(environment: Path, tmp_path: Path) -> None:
    names = run(environment, "python", "-c", STUDIES, folder=tmp_path).split()
    assert {"alexandersson2022", "meng2014", "qi2025", "section2d", "song2025", "yu2014"} <= set(names)


def test_it_is_the_wheel_that_was_run(environment: Path, tmp_path: Path) -> None:
    place = run(environment, "python", "-c", "import seatrial; print(seatrial.__file__)", folder=tmp_path)
    assert str(environment.parent) in place
