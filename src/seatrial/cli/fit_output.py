"""What `identify` prints of a fit: verdict and key figures, coefficients, held-out runs, findings."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.fit_details import (
    print_baselines,
    print_disturbances,
    print_frequency_responses,
    print_k_step_errors,
    print_method_comparison,
    print_model_selection,
    print_windows,
)
from seatrial.cli.run_errors import ERROR_DIGITS, error_text, label_and_unit, quantity_label, simulated_label
from seatrial.cli.screen import is_quiet, is_verbose, print_heading, print_lines, print_table
from seatrial.cli.summary_output import print_summary

if TYPE_CHECKING:
    from seatrial.core.results import Coefficient, Extrapolation, Fit, Measure, Prediction

# index of extrapolation beyond which intervals are lower limits; chosen, as in the report
EXTRAPOLATION_LIMIT = 1.2
EXTRAPOLATION_NOTE = ": beyond the training runs, read its intervals as lower limits"
NOT_DETERMINED = "not determined"
# measures and held-out runs that stand in the tables without --verbose; chosen, one screen
MAX_MEASURES, MAX_RUNS = 8, 4


def print_fit(fit: "Fit") -> None:
    """Print the verdict with its key figures, free coefficients, runs held out, and what was compared; then findings.

    With --verbose also windows, errors samples ahead, responses, disturbances, symmetries, and how it was estimated.
    """
    if is_quiet():
        return
    _print_summary(fit)
    if fit.reference is None:
        _print_coefficients(fit)
    else:
        print_method_comparison(fit, fit.reference)
    _print_held_out(fit)
    if fit.offset_populations:
        from seatrial.reporting.summary import offset_sentences

        print_heading("Offsets of a new session")
        print_lines(offset_sentences(fit), "  ")
    _print_thruster_craft(fit)
    _print_course_stability(fit)
    print_model_selection(fit)
    print_baselines(fit)
    if fit.posterior is not None:
        print_lines(fit.posterior.sentences)
    if is_verbose():
        _print_details(fit)
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


def _print_coefficients(fit: "Fit") -> None:
    """Estimates with as many digits as their intervals carry; columns in which nothing stands are left out."""
    from seatrial.reporting.mass_specific import with_mass_specific_units

    free = [c for c in with_mass_specific_units(fit).coefficients if not c.fixed]
    header = ("", "estimate", "std. error", "95 % from", "to", "unit", "known", "", "meaning")
    rows = [_coefficient_cells(c) for c in free]
    used = [k for k in range(len(header)) if any(row[k] for row in rows) and (k != 2 or is_verbose())]
    words = [i for i, k in enumerate(used) if header[k] in ("unit", "", "meaning")]
    print_heading("Coefficients, 95 % intervals")
    print_table([[row[k] for k in used] for row in (header, *rows)], flush_left=words)
    if fit.thruster_craft is not None and fit.thruster_craft.force_unit == "N/kg":
        print_lines([
            "  Forces and masses are those on each kg of m + m_x, as no thrust is known in newtons: times the mass and "
            "some 5 % of it for m_x they are newtons and kilograms. To estimate them, state bollard, the thrust of a "
            "thruster at full command, and ship.m."
        ])  # fmt: skip


def _coefficient_cells(c: "Coefficient") -> tuple[str, ...]:
    from seatrial.core.text.numbers import estimate_text, exact

    text = estimate_text(c.estimate, c.standard_error, c.lower, c.upper)
    numbers = [f"{part}{text.power}" for part in (text.value, text.error, text.lower, text.upper)]
    known = "" if c.truth is None else exact(c.truth)
    return c.name, *numbers, c.unit if c.unit != "1" else "", known, _coefficient_mark(c), c.meaning


def _coefficient_mark(c: "Coefficient") -> str:
    """Where a known value lies, else whether the interval leaves the sign open."""
    if c.lower is None or c.upper is None:
        return "no interval"
    if c.truth is not None:
        return "inside" if c.lower <= c.truth <= c.upper else "OUTSIDE"
    return "sign open" if c.is_sign_open else ""


def _print_held_out(fit: "Fit") -> None:
    chosen = fit.validation if is_verbose() else fit.validation[:MAX_RUNS]
    for p in chosen:
        _print_prediction(p, fit.predictions)
    if len(fit.validation) > len(chosen):
        print_lines(
            [f"... and {len(fit.validation) - len(chosen)} more held-out runs; --verbose and the report show them"]
        )


def _print_prediction(p: "Prediction", predictions: "Sequence[Prediction]") -> None:
    """Errors of a run that was not fitted, with what the process noise would leave; its measures with their marks."""
    from seatrial.core.text.numbers import duration, exact
    from seatrial.reporting.repeats import repeat_clause

    until = "" if p.divergence is None else f"; it diverges, its first {exact(p.divergence.seconds, 4)} s count"
    repeat = f"; {clause}" if (clause := repeat_clause(p, predictions)) else ""
    print_heading(f"Held out: {p.record}, {duration(p.measured.duration)}{until}{repeat}")
    if not p.rms:
        print_lines(["nothing can be compared: no channel of the run is an output of the model"])
        return
    table = [_error_header(p), *(_error_cells(p, key) for key in p.rms)]
    used = [k for k in range(len(table[0])) if any(row[k] for row in table[1:])]
    print_table([[row[k] for k in used] for row in table], flush_left=(0, len(used) - 1), indent="  ")
    if is_verbose():
        print_windows(p)
    if p.extrapolation is not None:
        _print_extrapolation(p.extrapolation)
    _print_measures(p)


def _error_header(p: "Prediction") -> list[str]:
    windows = [f"{w.count} x {w.window}" for w in p.windows]
    rival = f"best without fit, {p.windows[-1].window}" if p.windows else ""
    return ["rms error", "whole run", "process noise", "tied models", *windows, rival]


def _error_cells(p: "Prediction", key: str) -> list[str]:
    """Error over the whole run, what process noise leaves of it, over windows, and the best one that needs no fit."""
    tables = (p.rms, p.noise_floor, p.tied_spread, *({k: s.rms for k, s in w.scores.items()} for w in p.windows))
    errors = [error_text(key, table[key]) if key in table else "" for table in tables]
    rivals = [b for b in p.windows[-1].baselines if key in b.scores] if p.windows else []
    best = min(rivals, key=lambda b: b.scores[key].rms, default=None)
    rival = "" if best is None else f"{error_text(key, best.scores[key].rms)} {best.name}"
    is_beaten = bool(p.windows) and key in p.windows[-1].better_baselines
    return [", ".join(label_and_unit(key)), *errors, f"{rival} (BETTER)" if is_beaten else rival]


def _print_measures(p: "Prediction") -> None:
    from seatrial.core.text.numbers import exact

    chosen = list(p.measures.items()) if is_verbose() else list(p.measures.items())[:MAX_MEASURES]
    rows = [["", p.reference_word, "predicted", "95 % from", "to", ""]]
    words = (0, len(rows[0]) - 1)
    for name, m in chosen:
        if m.simulated is not None or not m.is_determined:
            simulated = exact(m.simulated, 4) if m.is_determined else NOT_DETERMINED
            ends = ("" if x is None or not m.is_determined else exact(x, 4) for x in (m.lower, m.upper))
            measured = "" if m.measured is None else exact(m.measured, 4)
            rows.append([quantity_label(name), measured, simulated, *ends, _measure_mark(name, m)])
    if len(rows) > 1:
        print_table(rows, flush_left=words, indent="  ")
    if len(p.measures) > len(chosen):
        print_lines([f"... and {len(p.measures) - len(chosen)} more; --verbose and the report show them"], "  ")


def _measure_mark(name: str, m: "Measure") -> str:
    from seatrial.reporting.measures import IntervalVerdict, interval_verdict

    verdict = interval_verdict(name, m)
    return verdict.upper() if verdict is IntervalVerdict.OUTSIDE else verdict.value


def _print_thruster_craft(fit: "Fit") -> None:
    """What a craft with thrusters does at full command."""
    from seatrial.core.text.numbers import exact
    from seatrial.reporting.measures import is_extrapolated
    from seatrial.reporting.thruster_chapter import FAR_NOTE, MEASURE_LABELS

    if fit.thruster_craft is None or not fit.thruster_craft.measures:
        return
    print_heading("At full command")
    rows = [["", "", "95 % from", "to"]]
    for name, m in fit.thruster_craft.measures.items():
        ends = ("" if x is None else exact(x, ERROR_DIGITS) for x in (m.lower, m.upper))
        label = f"{MEASURE_LABELS.get(name, quantity_label(name))}{' *' if is_extrapolated(m) else ''}"
        rows.append([label, exact(m.value, ERROR_DIGITS), *ends])
    print_table(rows, indent="  ")
    if any(is_extrapolated(m) for m in fit.thruster_craft.measures.values()):
        print_lines([FAR_NOTE], "  ")


def _print_course_stability(fit: "Fit") -> None:
    """Whether the craft holds a straight course, and how fast it leaves one."""
    from seatrial.core.results.fit import COURSE_UNSTABLE
    from seatrial.core.text.words import sentence
    from seatrial.reporting.grades import is_missed

    if fit.identifiability is None or fit.identifiability.stability is None:
        return
    turns = [f.evidence.partition("; ")[2] for f in fit.findings if f.code == COURSE_UNSTABLE]
    print_heading("Straight course")
    missed = "This is the model's, which does not predict the held-out run." if is_missed(fit) else ""
    print_lines([sentence(text) for text in (fit.identifiability.stability.text, *turns, missed) if text], "  ")


def _print_extrapolation(e: "Extrapolation") -> None:
    from seatrial.core.text.numbers import fixed

    note = EXTRAPOLATION_NOTE if e.index > EXTRAPOLATION_LIMIT else ""
    largest = next((name for name, ratio in e.ratios.items() if ratio == e.index), "")
    side = largest if largest.startswith("rudder to ") else ""
    reason = "by the drift angle that the model has" if largest == "drift" else f"no run trained so much {side}"
    source = f" ({reason})" if note and (side or largest == "drift") else ""
    kind = f"; no training run is a {e.untrained_kind.replace('-', ' ')}: extrapolated" if e.untrained_kind else ""
    print_lines([f"extrapolation index {fixed(e.index, 2)}{source}{note}{kind}"], "  ")


def _print_details(fit: "Fit") -> None:
    """What the estimate rests on: errors samples ahead, responses, symmetries, disturbances, method."""
    if fit.k_step_errors or fit.frequency_responses:
        print_heading("Samples ahead, and over frequency")
    print_k_step_errors(fit)
    print_frequency_responses(fit)
    noise_model = fit.noise_model
    if fit.identifiability is not None and fit.identifiability.structural:
        print_heading("What no manoeuvre can separate")
        print_lines((symmetry.text for symmetry in fit.identifiability.structural), "  ")
    print_heading("Method")
    if noise_model is not None:
        print_lines([f"{noise_model.method}: {noise_model.text}"] if noise_model.text else [])
        print_lines(noise_model.wave_sentences)
        print_lines(noise_model.closed_loop.sentences if noise_model.closed_loop is not None else [])
        print_disturbances(noise_model.candidates)
    print_lines([f"criterion: {fit.method.criterion}", f"intervals: {fit.method.intervals}"])


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
        _print_extrapolation(extrapolation)


def _simulated_measure(
    name: str, value: float, is_judged: bool, pair: Iterable[float] | None, label: Callable[[str], str]
) -> list[str]:
    from seatrial.core.text.numbers import exact

    ends = [exact(end, 4) for end in pair] if pair is not None else [NOT_DETERMINED if is_judged else "", ""]
    return [label(name), exact(value, 4), *ends]
