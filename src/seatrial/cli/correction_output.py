"""What follows from a check: the corrected trial file, and the next step."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial.cli.output import SEVERITY_MARK, in_shell, print_findings, print_lines

if TYPE_CHECKING:
    from seatrial.core.values import Finding
    from seatrial.data.trial.correction import Correction


def write_correction(correction: "Correction", trial: Path, per_code: int) -> None:
    """Write the corrected trial file beside the original, and print what was changed and what is left.

    Raises:
        InputError: there is a corrected file already.
    """
    from seatrial.core.values import InputError
    from seatrial.core.values.files import write_atomically
    from seatrial.data.trial.correction import change_lines

    fixed = trial.with_name(f"{trial.stem}.fixed.toml")
    print_lines(change_lines(correction))
    if not correction.applied:
        is_left = any(finding.severity.value == "error" for finding in correction.findings)
        why = "no error has an edit that removes it" if is_left else "the checks find no error"
        print(f"{SEVERITY_MARK['info']} nothing to correct: {why}; no file is written")
        print_findings(correction.findings, per_code)
        print(next_step(tuple(replace(one, edits=()) for one in correction.findings), trial))
        return
    if fixed.exists():
        raise InputError(f"'{fixed}' exists and is not overwritten; move or remove it")
    write_atomically(fixed, correction.text.encode())
    print_findings(correction.findings, per_code, f"seatrial check {in_shell(fixed)} --all shows them")
    print(f"corrected: {fixed}")
    print(f"Next: seatrial check {in_shell(fixed)}")


def next_step(findings: "tuple[Finding, ...]", trial: Path) -> str:
    """Return what to do after a check: correct, the advice of the first error, what a model lacks, or to identify."""
    from seatrial.core.text.plain import ascii_text

    errors = [finding for finding in findings if finding.severity.value == "error"]
    missing = next((finding for finding in findings if finding.code == "model"), None)
    if any(error.edits for error in errors):
        return f"Next: seatrial check {in_shell(trial)} --fix"
    if errors:
        return ascii_text(f"Next: {errors[0].advice}")
    if missing is not None:
        return ascii_text(f"Next: identify cannot start yet: {missing.advice}")
    return f"Next: seatrial identify {in_shell(trial)} --out results"
