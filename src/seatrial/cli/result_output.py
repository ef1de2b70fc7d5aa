"""What the terminal says of a finished result, of each kind."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.screen import is_quiet, is_verbose, print_heading, print_lines, print_sections, print_table

if TYPE_CHECKING:
    from seatrial.core.results import Design, Extrapolation, Fit, Study
    from seatrial.core.results.poster import Poster, PosterQuantity
    from seatrial.core.results.tuning import Controller, Tuning
    from seatrial.core.results.verification import Verification
    from seatrial.reporting.section import KeyFact


# Errors of runs on the terminal: under the names and in the units of the report, angles in degrees.

ERROR_DIGITS = 3  # significant ones of an error; chosen


def errors_text(rms: Mapping[str, float]) -> str:
    """Return errors with their names and units, ``heading 1.2 deg, r 0.3 deg/s``; rms as in `Prediction.rms`."""
    texts = []
    for key, value in rms.items():
        label, unit = label_and_unit(key)
        texts.append(f"{label} {error_text(key, value)} {unit}")
    return ", ".join(texts)


def label_and_unit(key: str) -> tuple[str, str]:
    """Return how the report names an error of `Prediction.rms`, or a measure, and the unit in which it is shown."""
    from seatrial.reporting.measures import measure_label
    from seatrial.reporting.verdict import ERROR_LABELS

    return ERROR_LABELS[key] if key in ERROR_LABELS else measure_label(key)


def quantity_label(name: str) -> str:
    """Return name and unit of a measure: ``advance, L``."""
    from seatrial.reporting.measures import measure_label

    return ", ".join(part for part in measure_label(name) if part)


def corrected_label(name: str) -> str:
    """Return name and unit of a measure of a run that is corrected for the current: ``advance, L``."""
    from seatrial.reporting.measures import bare_measure_label

    return ", ".join(part for part in bare_measure_label(name) if part)


def simulated_label(name: str) -> str:
    """Return name and unit of a measure of a simulated manoeuvre: ``advance in still water, L``."""
    from seatrial.reporting.measures import simulated_measure_label

    return ", ".join(part for part in simulated_measure_label(name) if part)


def error_text(key: str, value: float) -> str:
    """Return the number of an error of `Prediction.rms` in the unit of `label_and_unit`."""
    from seatrial.core.text.numbers import exact

    return exact(math.degrees(value) if key == "r" else value, ERROR_DIGITS)


# What `identify` prints of a fit: verdict and key figures, coefficients, held-out runs, findings.


def print_fit(fit: "Fit") -> None:
    """Print the verdict with its key figures, the chapters of the fit, and findings; with --verbose details, too."""
    if is_quiet():
        return
    from seatrial.reporting.model_chapter import with_mass_specific_units
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
    runs = sum(p.role == "training" for p in fit.predictions) or len(fit.records)
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


# What `design` prints: the verdict, findings, the manoeuvre compared with standard ones, the orders.


def print_design(design: "Design") -> None:
    """Print the verdict, the chapters, and findings."""
    from seatrial.core.text.numbers import duration
    from seatrial.reporting.design import key_facts, sections, verdict

    heading = f"Designed manoeuvre, {design.solution.evaluations} tried, {duration(design.elapsed_s)}"
    print_summary(heading, verdict(design), key_facts(design))
    print_sections(sections(design))
    print_warnings(design.findings)


# What `tune` prints: the gains with their margins, the chapters of the report, what the search took.


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
    from seatrial.reporting.verification import key_facts, sections, verdict

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


# What `reproduce` prints: the question, its answer, claims with their verdicts, checks with their limits.


def print_study(study: "Study") -> None:
    """Print the question with its answer, how many claims and checks have which verdict, and the report's chapters."""
    from seatrial.reporting.study import sections

    print_heading(study.question or study.title or study.name)
    print_lines(study.answer)
    print_lines([f"claims: {study.claim_counts or 'none'}", f"checks: {study.check_counts}"])
    print_sections(sections(study))


# The first lines of a result: heading, verdict, key figures with marks, as a report's first screen has them.

GOOD_MARKS = {True: "+", False: "!", None: ""}  # before a key figure that is good, or that limits the result


def print_summary(heading: str, verdict: str, facts: "Sequence[KeyFact]") -> None:
    """Print heading and verdict, and below them the key figures: + good, ! a limit of the result."""
    print_heading(heading)
    print_lines([verdict])
    print_table([(GOOD_MARKS[fact.is_good], fact.name, fact.text) for fact in facts], flush_left=(0, 1, 2), indent="  ")


# What `poster` prints.

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
