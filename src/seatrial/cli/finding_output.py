"""Findings on the terminal, by severity."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from seatrial.cli.screen import is_quiet, is_verbose, line_width, print_heading, print_lines, print_verbatim

if TYPE_CHECKING:
    from seatrial.core.values import Finding

SEVERITY_MARK = {"error": "ERROR  ", "warning": "warning", "info": "note   "}
_NOUNS = {"error": "error", "warning": "warning", "info": "note"}
_COLOURS = {"error": typer.colors.RED, "warning": typer.colors.YELLOW}
_INDENT = " " * 8  # below the text of a finding


def print_findings(
    findings: "Sequence[Finding]", per_code: int, rest: str = "--all shows them", *, is_brief: bool = False
) -> None:
    """Print findings by kind, errors first; of each kind the first few (all with --verbose), and where the rest is.

    In brief notes are only counted, and what follows is not printed; --verbose is never brief.
    """
    if is_quiet():
        _print_errors(findings)
        return
    order = list(SEVERITY_MARK)
    kinds: dict[tuple[str, str], list[Finding]] = {}
    for finding in findings:
        kinds.setdefault((finding.severity.value, finding.code), []).append(finding)
    for (severity, _), alike in sorted(kinds.items(), key=lambda item: order.index(item[0][0])):
        if severity == "info" and is_brief:
            continue
        shown = alike if is_verbose() else alike[:per_code]
        for finding in shown:
            print_finding(severity, f"[{finding.code}] {finding.text}")
        if len(alike) > len(shown):
            print_verbatim([f"{_INDENT}... and {len(alike) - len(shown)} more of this kind; {rest}"])
        if alike[0].consequence and not is_brief:
            print_lines([f"consequence: {alike[0].consequence}"], _INDENT)
        if alike[0].advice:
            print_lines([f"advice: {alike[0].advice}"], _INDENT)
    hidden = "; --verbose shows notes" if is_brief and any(severity == "info" for severity, _ in kinds) else ""
    where = "; codes in brackets: docs/bad-fit.md" if any(f.severity.value != "info" for f in findings) else ""
    print_lines([f"{count_sentence(findings)}{hidden}{where}"])


def has_errors(findings: "Sequence[Finding]") -> bool:
    """Return whether any of the findings is an error."""
    return any(finding.severity.value == "error" for finding in findings)


def exit_if_errors(findings: "Sequence[Finding]") -> None:
    """End the command where findings are errors, as bad input does.

    Raises:
        Exit: there are any.
    """
    from seatrial.cli import INPUT_EXIT_CODE

    if has_errors(findings):
        raise typer.Exit(INPUT_EXIT_CODE)


def print_warnings(findings: "Sequence[Finding]", rest: str = "the report lists them") -> None:
    """Print errors and warnings of a result, causes first, under a heading; with --verbose notes, too."""
    from seatrial.core.values import worst_first

    if findings:
        print_heading("Findings, causes first")
        print_findings(worst_first(findings), 1, rest, is_brief=not is_verbose())


def print_finding(severity: str, text: str) -> None:
    """Print a finding, its severity in colour on a terminal and its lines below one another."""
    from seatrial.core.text.plain import ascii_text, wrapped

    width = line_width()
    if is_quiet():
        return
    first, *further = wrapped(ascii_text(text), None if width is None else width - len(_INDENT))
    typer.echo(f"{typer.style(SEVERITY_MARK[severity], fg=_COLOURS.get(severity))} {first}")
    print_verbatim(f"{_INDENT}{line.strip()}" for line in further)


def count_sentence(findings: "Sequence[Finding]") -> str:
    """Return how many findings of each severity there are: ``2 errors, 1 warning, no notes``."""
    from seatrial.core.text.words import counted

    counts = {severity: sum(f.severity.value == severity for f in findings) for severity in SEVERITY_MARK}
    return ", ".join(counted(counts[severity], noun) for severity, noun in _NOUNS.items())


def _print_errors(findings: "Sequence[Finding]") -> None:
    """What --quiet leaves: the errors, one a line."""
    from seatrial.core.text.plain import ascii_text

    for finding in findings:
        if finding.severity.value == "error":
            print(ascii_text(f"{SEVERITY_MARK['error'].strip()} [{finding.code}] {finding.text}"))
