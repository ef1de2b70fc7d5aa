"""What `poster` prints."""

from typing import TYPE_CHECKING

from seatrial.cli.fit_output import NOT_DETERMINED
from seatrial.cli.screen import print_lines, print_table

if TYPE_CHECKING:
    from seatrial.core.results.poster import Poster

# significant digits of values; chosen
DIGITS = 4


def print_poster(poster: "Poster") -> None:
    """Print each manoeuvre with its quantities, intervals and what they rest on."""
    from seatrial.core.text.numbers import exact

    for m in poster.manoeuvres:
        if m.note:
            print_lines([f"{m.manoeuvre}: {m.note}"])
            continue
        rows = [[m.manoeuvre, "", "95 % from", "to", ""]]
        for q in m.quantities:
            value = exact(q.value, DIGITS) if q.is_determined else NOT_DETERMINED
            ends = ("" if v is None else exact(v, DIGITS) for v in (q.lower, q.upper))
            rows.append([q.name, value, *ends, q.basis.value])
        print_table(rows, flush_left=(0, len(rows[0]) - 1))
