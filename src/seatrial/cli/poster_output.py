"""What `poster` prints."""

from typing import TYPE_CHECKING

from seatrial.cli.run_errors import corrected_label, quantity_label, simulated_label
from seatrial.cli.screen import print_heading, print_lines, print_table

if TYPE_CHECKING:
    from seatrial.core.results.poster import Poster, PosterQuantity

# significant digits of values; chosen
DIGITS = 4


def print_poster(poster: "Poster") -> None:
    """Print each manoeuvre with its quantities, intervals and what they rest on."""
    from seatrial.core.text.numbers import exact
    from seatrial.reporting.measures import NOT_DETERMINED, manoeuvre_name
    from seatrial.reporting.poster import measured_words, rudder_rate_text

    for m in poster.manoeuvres:
        if m.note:
            print_lines([f"{manoeuvre_name(m.manoeuvre)}: {m.note}"])
            continue
        print_heading(manoeuvre_name(m.manoeuvre))
        rows = [["", "", "95 % from", "to", ""]]
        is_corrected = bool(m.runs) and all(run.current is not None for run in m.runs)
        for q in m.quantities:
            value = exact(q.value, DIGITS) if q.is_determined else NOT_DETERMINED
            ends = ("" if v is None else exact(v, DIGITS) for v in (q.lower, q.upper))
            rows.append([_label(q, is_corrected=is_corrected), value, *ends, f"{q.basis.value}{_range_text(q)}"])
        print_table(rows, flush_left=(0, len(rows[0]) - 1), indent="  ")
        if is_corrected:
            print_lines([f"{measured_words(m, 1.0)}: {', '.join(run.name for run in m.runs)}"], indent="  ")
    print_lines([rudder_rate_text(poster)])
    if poster.scale != 1.0:
        print_lines([f"at the scale of the trials, 1:{poster.scale:g}, but for the rudder rate; page at full scale"])


def _label(q: "PosterQuantity", *, is_corrected: bool) -> str:
    """Of a value corrected for the current without what its track refers to, which a line below says."""
    from seatrial.core.results.poster import Basis

    if q.basis is not Basis.MEASURED:
        return simulated_label(q.name)
    return corrected_label(q.name) if is_corrected else quantity_label(q.name)


def _range_text(q: "PosterQuantity") -> str:
    """``, largest of 2 from 18.4``; empty for one run."""
    from seatrial.core.text.numbers import exact

    return f", largest of {len(q.repeats)} from {exact(min(q.repeats), DIGITS)}" if q.repeats else ""
