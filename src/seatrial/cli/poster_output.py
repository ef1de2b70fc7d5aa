"""What `poster` prints."""

from typing import TYPE_CHECKING

from seatrial.cli.fit_output import NOT_DETERMINED
from seatrial.cli.run_errors import quantity_label, simulated_label
from seatrial.cli.screen import print_heading, print_lines, print_table

if TYPE_CHECKING:
    from seatrial.core.results.poster import Poster

# significant digits of values; chosen
DIGITS = 4


def print_poster(poster: "Poster") -> None:
    """Print each manoeuvre with its quantities, intervals and what they rest on."""
    from seatrial.core.results.poster import Basis
    from seatrial.core.text.numbers import exact
    from seatrial.reporting.measures import manoeuvre_name

    for m in poster.manoeuvres:
        if m.note:
            print_lines([f"{manoeuvre_name(m.manoeuvre)}: {m.note}"])
            continue
        print_heading(manoeuvre_name(m.manoeuvre))
        rows = [["", "", "95 % from", "to", ""]]
        for q in m.quantities:
            value = exact(q.value, DIGITS) if q.is_determined else NOT_DETERMINED
            ends = ("" if v is None else exact(v, DIGITS) for v in (q.lower, q.upper))
            label = quantity_label if q.basis is Basis.MEASURED else simulated_label
            rows.append([label(q.name), value, *ends, q.basis.value])
        print_table(rows, flush_left=(0, len(rows[0]) - 1), indent="  ")
    print_lines([poster.rudder_rate])
