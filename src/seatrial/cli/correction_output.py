"""What `check --fix` prints and writes: the corrected trial file."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import exit_if_errors, has_errors, print_finding, print_findings
from seatrial.cli.next_steps import after_check
from seatrial.cli.screen import in_shell, print_file, print_lines, print_next

if TYPE_CHECKING:
    from seatrial.core.values import Finding
    from seatrial.data.trial.load import Correction


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
