"""What `compare` prints."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.run_errors import simulated_label
from seatrial.cli.screen import print_heading, print_lines, print_table

if TYPE_CHECKING:
    from seatrial.core.results import Comparison, Difference

# significant digits of values; chosen
DIGITS = 5
MARKED = "'differs': by all rows of a table together (joint 95 %), stricter than the interval of one row by itself"


def print_comparison(comparison: "Comparison") -> None:
    """Print whether the fits differ, what else changed, differences of coefficients, then those of each manoeuvre."""
    from seatrial.reporting.comparison import outcome
    from seatrial.reporting.measures import manoeuvre_name

    print_heading(f"{comparison.first.name} (first) and {comparison.second.name} (second)")
    print_lines(outcome(comparison))
    if comparison.changes:
        print_heading("What else changed")
        print_lines(comparison.changes, "  ")
    print_heading("Differences, second minus first")
    print_lines([MARKED], "  ")
    _print_differences(comparison.coefficients, str)
    for m in comparison.manoeuvres:
        if m.measures:
            print_heading(manoeuvre_name(m.manoeuvre))
            _print_differences(m.measures, simulated_label)
        else:
            print_lines([f"{manoeuvre_name(m.manoeuvre)}: {m.note or 'no measure in common'}"], "  ")
    print_warnings(comparison.findings)


def _print_differences(rows: "Sequence[Difference]", label: Callable[[str], str]) -> None:
    from seatrial.core.text.numbers import exact

    if not rows:
        return
    table = [["", "first", "second", "difference", "95 % from", "to", ""]]
    for d in rows:
        numbers = ("" if v is None else exact(v, DIGITS) for v in (d.first, d.second, d.difference, d.lower, d.upper))
        table.append([label(d.name), *numbers, "differs" if d.is_significant else ""])
    print_table(table, flush_left=(0, len(table[0]) - 1), indent="  ")
