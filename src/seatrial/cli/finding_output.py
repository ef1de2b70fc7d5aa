"""Findings on the terminal, and corrections that were made."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from seatrial.cli.next_steps import after_check
from seatrial.cli.screen import (
    in_shell,
    is_quiet,
    is_verbose,
    line_width,
    print_file,
    print_heading,
    print_lines,
    print_next,
    print_verbatim,
)

if TYPE_CHECKING:
    from seatrial.core.values import Finding
    from seatrial.data.trial.load import Correction


# Findings on the terminal, by severity.

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
    where = "; codes in brackets: docs/findings.md" if any(f.severity.value != "info" for f in findings) else ""
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


# What `check --fix` prints and writes: the corrected trial file.


def write_correction(correction: "Correction", trial: Path, findings: "tuple[Finding, ...]", per_code: int) -> None:
    """Write the corrected trial file beside the original, and print what was changed and what is left.

    findings: of `check` on the file as it is, across its blocks too.

    Raises:
        InputError: there is a corrected file already.
        Exit: nothing is corrected and errors are left.
    """
    from seatrial.core.values import InputError
    from seatrial.core.values.files import write_atomically
    from seatrial.data.trial.load import change_lines

    fixed = trial.with_name(f"{trial.stem}.fixed.toml")
    print_lines(change_lines(correction))
    if not correction.applied:
        why = "no error has an edit that removes it" if has_errors(findings) else "the checks find no error"
        print_finding("info", f"nothing to correct: {why}; no file is written")
        print_findings(findings, per_code)
        print_next(after_check(tuple(replace(finding, edits=()) for finding in findings), trial))
        exit_if_errors(findings)
        return
    if fixed.exists():
        raise InputError(f"'{fixed}' exists and is not overwritten; move or remove it")
    write_atomically(fixed, correction.text.encode())
    print_findings(correction.findings, per_code, f"seatrial check {in_shell(fixed)} --all shows them")
    print_file("corrected", fixed)
    print_next(f"seatrial check {in_shell(fixed)}")
