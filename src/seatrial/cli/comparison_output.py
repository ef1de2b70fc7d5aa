"""What `compare` prints."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_findings
from seatrial.cli.screen import print_lines, print_table

if TYPE_CHECKING:
    from seatrial.core.results import Comparison, Difference

# significant digits of values; chosen
DIGITS = 5


def print_comparison(comparison: "Comparison") -> None:
    """Print what changed, differences of coefficients and their joint test, then those of each manoeuvre."""
    from seatrial.core.text.numbers import exact, p_value

    print_lines([f"first: {comparison.first.name}", f"second: {comparison.second.name}"])
    print_lines((change.replace("→", "->") for change in comparison.changes), "  ")
    if comparison.coefficients:
        _print_differences("coefficient", comparison.coefficients)
    test = comparison.joint_test
    if test is not None:
        statistic = f"chi-square {exact(test.statistic, 4)}, {test.degrees_of_freedom} degrees of freedom"
        print_lines([f"all coefficients together: {statistic}, {p_value(test.p)}"])
    for m in comparison.manoeuvres:
        if m.measures:
            _print_differences(m.manoeuvre, m.measures)
        else:
            print_lines([f"{m.manoeuvre}: {m.note or 'no measure in common'}"])
    if comparison.findings:
        print_findings(comparison.findings, 1)
    names = ", ".join(comparison.significant) or "nothing"
    print_lines([f"differs significantly (joint 95 %): {names}"])


def _print_differences(name: str, rows: "Sequence[Difference]") -> None:
    from seatrial.core.text.numbers import exact

    table = [[name, "first", "second", "difference", "95 % from", "to", ""]]
    for d in rows:
        numbers = ("" if v is None else exact(v, DIGITS) for v in (d.first, d.second, d.difference, d.lower, d.upper))
        table.append([d.name, *numbers, "differs" if d.is_significant else ""])
    print_table(table, flush_left=(0, len(table[0]) - 1))
