"""What `design` prints: the verdict, findings, the manoeuvre compared with standard ones, the orders."""

from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.section_output import print_sections
from seatrial.cli.summary_output import print_summary

if TYPE_CHECKING:
    from seatrial.core.results import Design


def print_design(design: "Design") -> None:
    """Print the verdict, the chapters, and findings."""
    from seatrial.core.text.numbers import duration
    from seatrial.reporting.design import sections
    from seatrial.reporting.design_text import key_facts, verdict

    heading = f"Designed manoeuvre, {design.solution.evaluations} tried, {duration(design.elapsed_s)}"
    print_summary(heading, verdict(design), key_facts(design))
    print_sections(sections(design))
    print_warnings(design.findings)
