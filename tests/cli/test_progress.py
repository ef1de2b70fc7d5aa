"""Progress: a line for each phase where nobody watches, nothing with --quiet, every report with --verbose."""

import sys
import time

import pytest

from seatrial.cli.progress import notices, progress_reporter
from seatrial.cli.screen import Detail, printing
from seatrial.numerics.kernels.kernel import _announce_compiling

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


def test_off_a_terminal_a_long_phase_says_at_each_doubling_how_far_it_is(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter(range(0, 1000, 10))  # s between two reports
    monkeypatch.setattr(time, "monotonic", lambda: float(next(clock)))
    with printing(Detail.NORMAL), progress_reporter() as report_progress:
        for part in range(10):
            report_progress(f"prediction: {part} of 10, run a")
        for count in range(3):
            report_progress(f"search: evaluation {count}, cost 7")
    assert capsys.readouterr().err.splitlines() == [
        "prediction",
        "  prediction: 20 s so far, about 80 s left",
        "  prediction: 40 s so far, about 60 s left",
        "  prediction: 80 s so far, about 20 s left",
        "search",
        "  search: 20 s so far, evaluation 2, cost 7",
    ]


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


def test_what_compiles_is_said_once_and_not_with_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    for detail, said in ((Detail.VERBOSE, 1), (Detail.QUIET, 0), (Detail.NORMAL, 0)):
        _announce_compiling.cache_clear()
        with printing(detail), notices():
            _announce_compiling()
            _announce_compiling()
        assert capsys.readouterr().err.count("compiling for this machine") == said
