"""The site builds without a warning: no dead link, no page outside the contents, no error in the notebook."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import seatrial


@pytest.fixture(scope="module")
def site(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the built site."""
    pytest.importorskip("myst_nb", reason="needs the extra 'dev'")
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-W",
        "--keep-going",
        "-q",
        "-D",
        "plot_gallery=0",  # `make docs` runs the recipes
        "-d",
        str(folder / "cache"),
        "docs",
        str(folder),
    ]
    run = subprocess.run(command, cwd=repository, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return folder


def test_the_notebook_shows_its_results(site: Path) -> None:
    page = (site / "notebooks" / "first_fit.html").read_text(encoding="utf-8")
    assert "Fit of model waterjet" in page and "True simulated" in page
    assert len(set(re.findall(r'<img [^>]*src="(\.\./_images/[^"]+)"', page))) == 3


def test_every_public_name_is_described(site: Path) -> None:
    page = (site / "api.html").read_text(encoding="utf-8")
    described = set(re.findall(r'id="seatrial\.(\w+)"', page)) | set(re.findall(r">st\.(\w+)<", page))
    assert set(seatrial.__all__) <= described
