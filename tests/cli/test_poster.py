"""The command `poster`: a page from a result folder, and what is refused."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.reporting.fabricated import fabricated_fit

import seatrial as st


def test_a_result_folder_becomes_a_poster(
    run_command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = st.save(fabricated_fit(), tmp_path / "fit")
    page = tmp_path / "poster.html"
    assert run_command("poster", Path(folder).parent if Path(folder).is_file() else folder, "--out", page) == 0
    assert "turning circle with 35 deg to port" in capsys.readouterr().out.lower()
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_a_folder_without_a_fit_is_refused(run_command: Callable[..., int], tmp_path: Path) -> None:
    assert run_command("poster", tmp_path, "--out", tmp_path / "poster.html") == 2
