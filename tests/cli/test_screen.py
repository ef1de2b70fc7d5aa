"""The screen: widths, headings, --quiet and --verbose of every command, findings by severity."""

from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.cli.finding_output import count_sentence, print_findings
from seatrial.cli.screen import Detail, line_width, print_heading, print_lines, print_next, print_table, printing
from seatrial.core.values import Finding, Severity

LONG = "a sentence of many words " * 6
FINDINGS = (
    Finding(Severity.INFO, "constant", "channel 'n' is constant", advice="its effect is that of a constant force"),
    Finding(Severity.ERROR, "wrong-sign", "the rudder turns the other way", "r 0.9"),
    Finding(Severity.WARNING, "gap", "a gap of 3 s"),
    Finding(Severity.WARNING, "gap", "a gap of 4 s"),
)


def test_lines_are_cut_at_the_terminals_width_and_not_in_a_pipe(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    assert line_width() is None
    print_lines([LONG])
    assert len(capsys.readouterr().out.splitlines()) == 1
    monkeypatch.setenv("COLUMNS", "80")
    print_lines([LONG], "  ")
    print_table([["name", "1.0", LONG]], flush_left=(0, 2))
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0].startswith("  a sentence") and lines[1].startswith("    ")
    monkeypatch.setenv("COLUMNS", "400")
    assert line_width() == 120


def test_a_command_to_be_copied_is_never_cut(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    print_next(f"seatrial identify {'x' * 60}.toml --out results")
    assert capsys.readouterr().out == f"Next: seatrial identify {'x' * 60}.toml --out results\n"


def test_findings_stand_by_severity_with_their_count(capsys: pytest.CaptureFixture[str]) -> None:
    print_findings(FINDINGS, 1)
    lines = capsys.readouterr().out.splitlines()
    assert [line[:7].strip() for line in lines] == ["ERROR", "", "", "warning", "", "note", "", "1 error"]
    assert lines[0] == "ERROR   [wrong-sign] the rudder turns the other way (r 0.9)"
    assert lines[1].strip().startswith("consequence: coefficients get the wrong sign")
    assert lines[2].strip() == "advice: seatrial check --fix"
    assert lines[4].strip() == "... and 1 more of this kind; --all shows them"
    assert count_sentence(FINDINGS) == "1 error, 2 warnings, 1 note"
    assert lines[-1] == f"{count_sentence(FINDINGS)}; codes in brackets: docs/findings.md"


def test_quiet_leaves_errors_and_verbose_shows_all(capsys: pytest.CaptureFixture[str]) -> None:
    with printing(Detail.QUIET):
        print_findings(FINDINGS, 1)
        print_heading("Findings")
    assert capsys.readouterr().out == "ERROR [wrong-sign] the rudder turns the other way (r 0.9)\n"
    with printing(Detail.VERBOSE):
        print_findings(FINDINGS, 1)
    assert "a gap of 4 s" in capsys.readouterr().out


def test_every_command_takes_quiet_and_verbose_but_not_both(
    run_command: Callable[..., int], capsys: pytest.CaptureFixture[str], repository: Path
) -> None:
    trial = repository / "examples" / "waterjet.toml"
    assert run_command("check", trial, "--quiet") == 0
    assert capsys.readouterr().out == ""
    assert run_command("check", trial, "-v") == 0
    assert capsys.readouterr().out.count("channel 'v_j' is constant") == 3
    assert run_command("check", trial, "-q", "-v") == 2
    assert "--quiet and --verbose exclude one another" in capsys.readouterr().err
    for command in ("identify", "design", "tune", "simulate", "follow", "models", "init", "export", "reproduce"):
        assert run_command(command, "--help") == 0
        assert "--quiet" in capsys.readouterr().out


def test_quiet_prints_the_names_of_files(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture[str], repository: Path
) -> None:
    out = tmp_path / "roll"
    assert run_command("identify", repository / "examples" / "fin_decay.toml", "--out", out, "--quiet") == 0
    captured = capsys.readouterr()
    assert captured.out == f"report: {out / 'report.html'}\n"
    assert captured.err == ""
