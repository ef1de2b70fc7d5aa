"""What `identify` prints of a fit: verdict and key figures, coefficients, held-out runs, findings."""

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.run_errors import quantity_label, simulated_label
from seatrial.cli.screen import is_quiet, is_verbose, print_heading, print_lines, print_table
from seatrial.cli.section_output import print_sections
from seatrial.cli.summary_output import print_summary

if TYPE_CHECKING:
    from seatrial.core.results import Extrapolation, Fit


def print_fit(fit: "Fit") -> None:
    """Print the verdict with its key figures, the chapters of the fit, and findings; with --verbose details, too."""
    if is_quiet():
        return
    from seatrial.reporting.mass_specific import with_mass_specific_units
    from seatrial.reporting.page import sections
    from seatrial.reporting.section import Level

    _print_summary(fit)
    print_sections(sections(with_mass_specific_units(fit), Level.DETAIL if is_verbose() else Level.NORMAL))
    if is_verbose():
        print_heading("Method")
        print_lines([f"criterion: {fit.method.criterion}", f"intervals: {fit.method.intervals}"])
    print_warnings(fit.findings)


def _print_summary(fit: "Fit") -> None:
    from seatrial.core.text.numbers import duration
    from seatrial.core.text.words import counted
    from seatrial.reporting.key_facts import key_facts
    from seatrial.reporting.verdict import verdict

    free = sum(not c.fixed for c in fit.coefficients)
    runs = sum(p.role == "training" for p in fit.predictions)
    sizes = f"{counted(free, 'coefficient')} from {counted(runs, 'run')}"
    heading = f"{fit.ship.name}: model {fit.model.name}, {sizes}, computed in {duration(fit.elapsed_s)}"
    print_summary(heading, verdict(fit), key_facts(fit))


def print_measures(
    measures: Mapping[str, float],
    intervals: Mapping[str, tuple[float, float] | None],
    extrapolation: "Extrapolation | None",
    *,
    is_manoeuvre: bool,
) -> None:
    """Print measures of a simulation with their 95 % intervals, and how far it leaves the training runs.

    is_manoeuvre: it was steered through one, in still water; else it repeats a run.
    """
    label = simulated_label if is_manoeuvre else quantity_label
    rows = [
        _simulated_measure(name, value, name in intervals, intervals.get(name), label)
        for name, value in measures.items()
    ]
    if rows:
        head = ["", "", "95 % from", "to"] if intervals else ["", ""]
        print_table([head, *(row[: len(head)] for row in rows)], indent="  ")
    if extrapolation is not None:
        from seatrial.reporting.measures import extrapolation_text

        print_lines([f"Extrapolation index {extrapolation_text(extrapolation)}"], "  ")


def _simulated_measure(
    name: str, value: float, is_judged: bool, pair: Iterable[float] | None, label: Callable[[str], str]
) -> list[str]:
    from seatrial.core.text.numbers import exact
    from seatrial.reporting.measures import NOT_DETERMINED

    ends = [exact(end, 4) for end in pair] if pair is not None else [NOT_DETERMINED if is_judged else "", ""]
    return [label(name), exact(value, 4), *ends]
