"""What `tune` prints: the gains with their margins, the chapters of the report, what the search took."""

import math
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.screen import print_heading, print_lines
from seatrial.cli.section_output import print_sections
from seatrial.cli.summary_output import print_summary

if TYPE_CHECKING:
    from seatrial.core.results.tuning import Controller, Tuning
    from seatrial.core.results.verification import Verification


def print_tuning(tuning: "Tuning") -> None:
    """Print everything a tuning contains, the chosen gains first."""
    from seatrial.core.text.numbers import exact
    from seatrial.reporting.tuning import sections
    from seatrial.reporting.tuning_text import key_facts, verdict

    gains = ", ".join(f"{name} {exact(value, 5)}" for name, value in tuning.chosen.gains.items())
    print_summary(tuning.name, verdict(tuning), key_facts(tuning))
    print_heading("Chosen gains")
    print_lines([gains, _margins_text(tuning.chosen)], "  ")
    print_sections(sections(tuning))
    print_warnings(tuning.findings)
    print_lines([_effort_text(tuning)])


def print_verification(verification: "Verification") -> None:
    """Print the verdict, predicted beside achieved values, the model before and with the log, legs or changes."""
    from seatrial.reporting.verification import sections
    from seatrial.reporting.verification_text import key_facts, verdict

    inside = sum(q.is_inside for q in verification.quantities)
    title = f"{verification.name}: {inside} of {len(verification.quantities)} as predicted"
    print_summary(title, verdict(verification), key_facts(verification))
    print_sections(sections(verification))
    print_warnings(verification.findings)


def _effort_text(tuning: "Tuning") -> str:
    """What each part of the work took; with a published search, the parts that it is compared with, too."""
    from seatrial.control.front import FRONT_NAME
    from seatrial.core.text.numbers import duration

    search = tuning.search
    if search is None:
        return f"{tuning.solution.evaluations} controllers tried; {duration(tuning.elapsed_s)}"
    fronts = (tuning.front, *(front for front in tuning.extended_fronts if front.name != FRONT_NAME))
    return "; ".join([
        f"one genetic search: {search.evaluations} controllers tried{_cpu_text(search.cpu_s)}; made with "
        f"{len(search.gains)} seeds",
        *(f"front of {one.name}: {one.evaluations} controllers{_cpu_text(one.cpu_s)}" for one in fronts),
        f"everything with its checks: {duration(tuning.elapsed_s)}",
    ])  # fmt: skip


def _cpu_text(cpu_s: float) -> str:
    from seatrial.core.text.numbers import duration

    return f", {duration(cpu_s)} of CPU time" if math.isfinite(cpu_s) else ""


def _margins_text(c: "Controller") -> str:
    from seatrial.core.text.numbers import exact, fixed
    from seatrial.reporting.tuning_text import margin_texts

    if not math.isfinite(c.Ms):
        return "unstable"
    return f"Ms {exact(c.Ms, 3)}, {', '.join(margin_texts(c))}, damping {fixed(c.damping, 2)}"
