"""What `reproduce` prints: the question, its answer, claims with their verdicts, checks with their limits."""

from typing import TYPE_CHECKING

from seatrial.cli.screen import print_heading, print_lines
from seatrial.cli.section_output import print_sections

if TYPE_CHECKING:
    from seatrial.core.results import Study


def print_study(study: "Study") -> None:
    """Print the question with its answer, how many claims and checks have which verdict, and the report's chapters."""
    from seatrial.reporting.study import sections

    print_heading(study.question or study.title or study.name)
    print_lines(study.answer)
    print_lines([f"claims: {study.claim_counts or 'none'}", f"checks: {study.check_counts}"])
    print_sections(sections(study))
