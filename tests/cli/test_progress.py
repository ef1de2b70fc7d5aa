"""Progress: a line for each phase where nobody watches, nothing with --quiet, every report with --verbose."""

import sys
import time

import pytest

from seatrial.cli.progress import progress_reporter
from seatrial.cli.screen import Detail, printing

REPORTS = (
    *(f"search, 12 segments: evaluation {count}, cost {1e3 / count:.6g}" for count in range(1, 40)),
    "prediction: 1 of 2, run a", "prediction: 2 of 2, run b", "report",
)  # fmt: skip


def reported(detail: Detail, capsys: pytest.CaptureFixture[str]) -> list[str]:
    with printing(detail), progress_reporter() as report_progress:
        for text in REPORTS:
            report_progress(text)
    return capsys.readouterr().err.splitlines()


def test_off_a_terminal_each_phase_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert reported(Detail.NORMAL, capsys) == ["search, 12 segments", "prediction", "report"]


def test_quiet_prints_none_and_verbose_every_report(capsys: pytest.CaptureFixture[str]) -> None:
    assert reported(Detail.QUIET, capsys) == []
    assert reported(Detail.VERBOSE, capsys) == list(REPORTS)


def test_a_terminal_keeps_a_line_of_a_long_phase_and_shows_what_is_left(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    with progress_reporter() as report_progress:
        report_progress("prediction: 0 of 5, run a")
        time.sleep(0.5)  # s: longer than a phase that leaves no line
        report_progress("prediction: 1 of 5, run b")
        time.sleep(0.3)  # s: longer than the terminal waits before it draws again
        report_progress("report")
    shown = capsys.readouterr().err
    assert "about 2 s left" in shown or "about 3 s left" in shown
    assert "  prediction  0." in shown
