"""The first lines of a result: heading, verdict, key figures with marks, as a report's first screen has them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from seatrial.cli.screen import print_heading, print_lines, print_table

if TYPE_CHECKING:
    from seatrial.reporting.first_screen import KeyFact

GOOD_MARKS = {True: "+", False: "!", None: ""}  # before a key figure that is good, or that limits the result


def print_summary(heading: str, verdict: str, facts: "Sequence[KeyFact]") -> None:
    """Print heading and verdict, and below them the key figures: + good, ! a limit of the result."""
    print_heading(heading)
    print_lines([verdict])
    print_table([(GOOD_MARKS[fact.is_good], fact.name, fact.text) for fact in facts], flush_left=(0, 1, 2), indent="  ")
