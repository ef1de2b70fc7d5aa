"""What `tune --verify` prints: predicted and achieved values, what was wrong, the legs."""

from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.screen import print_heading, print_lines, print_table
from seatrial.cli.summary_output import print_summary

if TYPE_CHECKING:
    from seatrial.core.results.verification import Verification
    from seatrial.reporting.text_tables import TextTable


def print_verification(verification: "Verification") -> None:
    """Print the verdict, predicted beside achieved values, the model before and with the log, legs or changes."""
    from seatrial.reporting.verification_text import key_facts, tables, verdict

    inside = sum(q.is_inside for q in verification.quantities)
    title = f"{verification.name}: {inside} of {len(verification.quantities)} as predicted"
    print_summary(title, verdict(verification), key_facts(verification))
    for table in tables(verification).values():
        _print_table(table)
    print_warnings(verification.findings)


def _print_table(table: "TextTable") -> None:
    print_heading(table.title)
    flush_left = [k for k, is_number in enumerate(table.numeric) if not is_number]
    print_table([table.header, *table.rows], flush_left=flush_left, indent="  ")
    if table.note:
        print_lines([table.note], "  ")
