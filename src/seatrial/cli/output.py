"""What the commands print and write: findings, fits and studies as text, progress, JSON."""

import re
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatrial.cli.run_errors import ERROR_DIGITS, error_text, errors_text, label_and_unit

if TYPE_CHECKING:
    from seatrial.core.results import (
        Baseline,
        CandidateModel,
        DisturbanceCandidate,
        Extrapolation,
        Fit,
        Prediction,
        ReferenceEstimate,
        Study,
        WindowScore,
    )
    from seatrial.core.values import Finding

# index of extrapolation beyond which intervals are lower limits; chosen, as in the report
EXTRAPOLATION_LIMIT = 1.2
EXTRAPOLATION_NOTE = ": beyond the training runs, read its intervals as lower limits"
NOT_DETERMINED = "not determined"
SEVERITY_MARK = {"error": "ERROR  ", "warning": "warning", "info": "note   "}
_NUMBERS = re.compile(r"\d[\d.e+-]*")
DIGITS = 5  # significant ones of estimates; chosen


def in_shell(path: Path) -> str:
    """Return a path as it is typed in a command: quoted where it has spaces or brackets."""
    return shlex.quote(str(path))


def print_lines(lines: Iterable[str], indent: str = "") -> None:
    """Print lines without typographic signs, so that any terminal shows them and numbers can be copied."""
    from seatrial.core.text.plain import ascii_text

    for line in lines:
        print(indent + ascii_text(line))


def print_table(rows: Sequence[Sequence[str]], flush_left: Sequence[int] = (0,), indent: str = "") -> None:
    """Print rows whose columns line up; those of `flush_left` are flush left."""
    from seatrial.core.text.plain import aligned, ascii_text

    print_lines(aligned([[ascii_text(cell) for cell in row] for row in rows], flush_left), indent)


def print_findings(findings: "Sequence[Finding]", per_code: int, rest: str = "--all shows them") -> None:
    """Print findings by kind, errors first; of each kind the first few, and where the `rest` is shown."""
    from seatrial.core.text.words import counted

    order = list(SEVERITY_MARK)
    kinds = {
        (f.severity.value, f.code): [g for g in findings if g.code == f.code and g.severity is f.severity]
        for f in findings
    }
    for (severity, code), alike in sorted(kinds.items(), key=lambda item: order.index(item[0][0])):
        print_lines(f"{SEVERITY_MARK[severity]} [{code}] {finding.text}" for finding in alike[:per_code])
        if len(alike) > per_code:
            print(f"        ... and {len(alike) - per_code} more of this kind; {rest}")
        if alike[0].consequence:
            print_lines([f"        consequence: {alike[0].consequence}"])
        if alike[0].advice:
            print_lines([f"        advice: {alike[0].advice}"])
    errors = sum(finding.severity.value == "error" for finding in findings)
    print(f"{counted(len(findings), 'finding')}, {counted(errors, 'error')} among them")


def print_fit(fit: "Fit") -> None:
    """Print free coefficients, predictions of the runs held out, models and estimators compared, identifiability."""
    from seatrial.core.text.numbers import duration

    if fit.reference is None:
        _print_coefficients(fit)
    else:
        _print_method_comparison(fit, fit.reference)
    for p in fit.validation:
        _print_prediction(p)
    print_lines(population.sentence for population in fit.offset_populations)
    _print_k_step_errors(fit)
    _print_frequency_responses(fit)
    _print_thruster_craft(fit)
    _print_model_selection(fit)
    _print_baselines(fit)
    _print_identifiability(fit)
    _print_warnings(fit)
    _print_sampling(fit)
    print_lines([f"intervals: {fit.method.intervals}", f"{fit.method.criterion}; {duration(fit.elapsed_s)}"])


def _print_sampling(fit: "Fit") -> None:
    if fit.posterior is not None:
        print_lines(fit.posterior.sentences)


def _print_warnings(fit: "Fit") -> None:
    """Warnings, those on the fit before those on the records; what is only worth knowing stays in the report."""
    warnings = [f for f in fit.findings if f.severity.value != "info"]
    if warnings:
        print_findings(warnings[::-1], 1, "the report lists them")


def _print_coefficients(fit: "Fit") -> None:
    from seatrial.core.text.numbers import exact, significant

    has_truth = any(c.truth is not None for c in fit.coefficients)
    rows = [["coefficient", "estimate", "std. error", "95 % from", "to", *(["known"] if has_truth else []), ""]]
    for c in fit.coefficients:
        if not c.fixed:
            numbers = [exact(c.estimate, DIGITS), significant(c.standard_error, 2), exact(c.lower, DIGITS),
                       exact(c.upper, DIGITS), *([exact(c.truth, DIGITS)] if has_truth else [])]  # fmt: skip
            rows.append([c.name, *numbers, c.unit if c.unit != "1" else ""])
    print_table(rows, flush_left=(0, len(rows[0]) - 1))


def _print_method_comparison(fit: "Fit", reference: "ReferenceEstimate") -> None:
    """A published method beside the package's own estimate: coefficients, then what each took and how it predicts."""
    from seatrial.core.results.method_comparison import (
        coefficient_comparison,
        cost_comparison,
        inside_own_intervals,
    )

    for table in (coefficient_comparison(fit, reference), cost_comparison(fit, reference)):
        last = len(table.header) - 1
        print_table([table.header, *table.rows], flush_left=(0, last) if table.header[last] == "unit" else (0,))
    print(inside_own_intervals(fit, reference))
    if fit.search is not None:
        stopped = "interrupted: " if fit.search.is_interrupted else ""
        used = "best" if fit.search.fitness == "record" else "first"
        print(f"{stopped}{fit.search.effort}{f'; the {used} is used' if len(fit.search.restarts) > 1 else ''}")


def _print_prediction(p: "Prediction") -> None:
    from seatrial.core.text.numbers import exact

    rms = f"rms {errors_text(p.rms)}" if p.rms else "no error, nothing can be compared"
    until = "" if p.divergence is None else f"; it diverges, and its first {exact(p.divergence.seconds, 4)} s count"
    print_lines([f"validation {p.record}: {rms}{until}"])
    for w in p.windows:
        _print_window(w)
    if p.noise_floor:
        print_lines([f"process noise alone: {errors_text(p.noise_floor)}"], "  ")
    if p.tied_spread:
        print_lines([f"tied models differ by: {errors_text(p.tied_spread)}"], "  ")
    if p.extrapolation is not None:
        _print_extrapolation(p.extrapolation)
    for name, m in p.measures.items():
        measured = "" if m.measured is None else f", {p.reference_word} {exact(m.measured, 4)}"
        if not m.is_determined:
            print_lines([f"{name}: {NOT_DETERMINED}{measured}"], "  ")
        elif m.simulated is not None and m.lower is not None and m.upper is not None:
            print_lines([f"{name}: {exact(m.simulated, 4)} [{exact(m.lower, 4)}, {exact(m.upper, 4)}]{measured}"], "  ")


def _print_k_step_errors(fit: "Fit") -> None:
    """One line: errors at the shortest and the longest horizon, of the runs held out where there are any."""
    from seatrial.core.text.numbers import exact
    from seatrial.core.values import display_unit

    held = [e for e in fit.k_step_errors if e.role == "validation"]
    errors = held or list(fit.k_step_errors)
    if not errors:
        return
    steps, seconds = errors[0].steps, errors[0].seconds
    ahead = " to ".join(dict.fromkeys(f"{steps[k]} ({exact(seconds[k], ERROR_DIGITS)} s)" for k in (0, -1)))
    texts = []
    for e in errors:
        factor, unit = display_unit(e.unit)
        ends = dict.fromkeys(exact(factor * e.rms[k], ERROR_DIGITS) for k in (0, -1))
        texts.append(f"{e.channel} {' to '.join(ends)} {unit}")
    print_lines([f"samples ahead {ahead}, {'held-out' if held else 'training'} runs, rms: {', '.join(texts)}"])


def _print_frequency_responses(fit: "Fit") -> None:
    """One line: at how many frequencies the model lies within the 95 % region of the records."""
    from seatrial.core.text.numbers import exact

    texts = []
    for r in fit.frequency_responses:
        compared = r.is_compared
        if compared.any():
            low, high = (exact(w, 2) for w in r.excited_range)
            inside = int((r.is_inside & compared).sum())
            texts.append(f"{r.output}/{r.input} {inside} of {int(compared.sum())} ({low} to {high} rad/s)")
    if texts:
        print_lines([f"frequency response, model inside the records' 95 % region: {', '.join(texts)}"])


def _print_thruster_craft(fit: "Fit") -> None:
    """One line: what a craft with thrusters does at full command."""
    from seatrial.core.text.numbers import exact

    if fit.thruster_craft is not None and fit.thruster_craft.measures:
        texts = []
        for name, m in fit.thruster_craft.measures.items():
            interval = "" if m.lower is None else f" [{exact(m.lower, ERROR_DIGITS)}, {exact(m.upper, ERROR_DIGITS)}]"
            texts.append(f"{name} {exact(m.value, ERROR_DIGITS)}{interval}")
        print_lines([f"at full command: {', '.join(texts)}"])


def _print_window(w: "WindowScore") -> None:
    """Where a baseline errs less that comes first; then the scores by channel with those of the baselines."""
    from seatrial.core.text.numbers import fixed
    from seatrial.core.text.words import counted

    better = [f"{label_and_unit(name)[0]} by {baseline}" for name, baseline in w.better_baselines.items()]
    note = f"; predicted better without this fit: {', '.join(better)}" if better else ""
    print_lines([f"{counted(w.count, 'window')} of {w.window}{note}"], "  ")
    rows = [["", "rms", "fit %", "R2", "in band", *(b.name for b in w.baselines)]]
    for name, s in w.scores.items():
        band = "" if s.inside_band is None else f"{100.0 * s.inside_band:.0f} %"
        rivals = [error_text(name, b.scores[name].rms) if name in b.scores else "" for b in w.baselines]
        name_and_unit, error = ", ".join(label_and_unit(name)), error_text(name, s.rms)
        rows.append([name_and_unit, error, fixed(s.fit_percent, 1), fixed(s.r_squared, 3), band, *rivals])
    print_table(rows, indent="    ")


def _print_extrapolation(e: "Extrapolation") -> None:
    from seatrial.core.text.numbers import fixed

    note = EXTRAPOLATION_NOTE if e.index > EXTRAPOLATION_LIMIT else ""
    print_lines([f"extrapolation index {fixed(e.index, 2)}{note}"], "  ")


def _print_model_selection(fit: "Fit") -> None:
    from seatrial.core.text.numbers import exact

    if not fit.candidate_models:
        return
    is_roll = any(m.roll_deg is not None for m in fit.candidate_models)
    rows = [["models, runs left out", "free", *(["roll deg"] if is_roll else ["heading deg", "position m"]), ""]]
    for m in fit.candidate_models:
        scores = (m.roll_deg,) if is_roll else (m.heading_deg, m.position_m)
        marks = ", ".join(
            word
            for word, holds in (
                ("used", m.is_chosen),
                ("tied", m.is_tied),
                (_gain_text(m), m.gain_percent),
                (m.note, m.note),
            )
            if holds
        )
        rows.append([m.name, str(m.free_count), *(exact(x, ERROR_DIGITS) for x in scores), marks])
    print_table(rows, flush_left=(0, len(rows[0]) - 1))


def _gain_text(m: "CandidateModel") -> str:
    """By how much a model errs less, or more, than the one it extends."""
    gain = m.gain_percent or 0.0
    return f"{abs(gain):.1f} % {'better' if gain > 0.0 else 'worse'}"


def _print_baselines(fit: "Fit") -> None:
    """How far each estimator is from the fit, or from the truth where it is known, and how it predicts."""
    from seatrial.core.text.numbers import exact

    if not fit.baselines:
        return
    first = fit.baselines[0]
    reference = "errors" if first.error else "from this fit"
    head = [f"other estimators: {reference}, %", "median", "worst", *_error_columns(first).values(), "CC u, v, r"]
    rows = [head, *([r.name[:60], *_baseline_cells(r, first, fit)] for r in fit.baselines)]
    print_table(rows, flush_left=(0, len(head) - 1))
    for r in fit.baselines:
        scores = (f"{equation} CC {exact(s.correlation, ERROR_DIGITS)}, explained {exact(s.explained, ERROR_DIGITS)}"
                  for equation, s in r.test.items())  # fmt: skip
        if r.test:
            print_lines([f"test rows, {r.name[:60]}: {'; '.join(scores)}"], "  ")
        print_lines((f"{SEVERITY_MARK[f.severity.value]} [{f.code}] {r.name[:60]}: {f.text}" for f in r.findings), "  ")
    print("  good trajectories and correlations (CC) prove nothing about coefficients")


def _error_columns(fit: "Baseline") -> dict[str, str]:
    """Two errors of simulated runs by which estimators are compared, and their names: of a track, else of waves."""
    columns = {"psi_deg": "heading deg", "position_m": "position m"}
    return {"theta_deg": "pitch deg", "z": "heave m"} if "z" in fit.training.rms else columns


def _baseline_cells(baseline: "Baseline", reference: "Baseline", fit: "Fit") -> list[str]:
    """Median and largest error, errors and correlations of the runs held out, or of training runs; or why none."""
    from statistics import median

    from seatrial.core.text.numbers import exact, fixed

    sizes = [100.0 * abs(away) for away in baseline.relative_deviation(reference).values()]
    errors = [exact(median(sizes), ERROR_DIGITS), exact(max(sizes), ERROR_DIGITS)] if sizes else ["", ""]
    if baseline.note:
        return [*errors, "", "", f"failed: {baseline.note}"]
    if baseline.diverged:
        count = f"{len(baseline.diverged)} of {len(fit.predictions)} runs"
        return [*errors, "", "", f"diverges in {count}, {baseline.diverged[0]} first"]
    runs = baseline.validation if fit.validation else baseline.training
    cells = [exact(runs.rms.get(key), ERROR_DIGITS) for key in _error_columns(fit.baselines[0])]
    return [*errors, *cells, ", ".join(fixed(cc, 3) for cc in runs.correlation.values())]


def _print_identifiability(fit: "Fit") -> None:
    identifiability, noise_model = fit.identifiability, fit.noise_model
    if identifiability is not None:
        free = sum(not c.fixed for c in fit.coefficients)
        print(f"the records determine about {identifiability.effective_parameters:.0f} of {free} free coefficients")
        print_lines((f"no record can separate: {symmetry.text}" for symmetry in identifiability.structural), "  ")
    if noise_model is not None and noise_model.text:
        print_lines([f"{noise_model.method}: {noise_model.text}"])
    if noise_model is not None and noise_model.closed_loop is not None:
        print_lines(noise_model.closed_loop.sentences)
    if noise_model is not None and noise_model.candidates:
        _print_disturbances(noise_model.candidates)


def _print_disturbances(candidates: "Sequence[DisturbanceCandidate]") -> None:
    from seatrial.core.text.numbers import exact, fixed, p_value

    rows = [["disturbance", "log-likelihood", "dof", "ratio", "by chance", "innovations", "held-out", ""]]
    for c in candidates:
        ratios = [fixed(c.likelihood_ratio, 1), fixed(c.critical_ratio, 1)] if c.critical_ratio > 0.0 else ["", ""]
        verdict = f"{'white' if c.is_white else 'not white'}, {p_value(c.whiteness_p)}"
        held_out = "" if c.held_out_score is None else exact(c.held_out_score, DIGITS)
        used = "used" if c.is_chosen else ""
        rows.append([c.name, fixed(c.log_likelihood, 1), str(c.degrees_of_freedom), *ratios, verdict, held_out, used])
    print_table(rows, flush_left=(0, 5, 7), indent="  ")  # columns of words: name, verdict, use


def print_measures(
    measures: Mapping[str, float],
    intervals: Mapping[str, tuple[float, float] | None],
    extrapolation: "Extrapolation | None",
) -> None:
    """Print measures of a simulated manoeuvre with their 95 % intervals, and how far it leaves the training runs."""
    from seatrial.core.text.numbers import exact

    rows = []
    for name, value in measures.items():
        pair = intervals.get(name)
        text = "" if pair is None else f"[{', '.join(exact(end, 4) for end in pair)}]"
        rows.append([name, exact(value, 4), NOT_DETERMINED if pair is None and name in intervals else text])
    print_table(rows, flush_left=(0, 2), indent="  ")
    if extrapolation is not None:
        _print_extrapolation(extrapolation)


def print_study(study: "Study") -> None:
    """Print the question with its answer, claims with their verdicts, checks with their limits, and their numbers."""
    from seatrial.core.results import CheckStatus
    from seatrial.core.text.numbers import exact

    print_lines(line for line in (study.question, *study.answer) if line)
    rows = []
    for claim in study.claims:
        setting = f". Setting: {claim.setting}" if claim.setting else ""
        rows.append([claim.verdict, f"{claim.claim}: {claim.evidence}{setting}"])
    for check in study.checks:
        limit = check.limit if isinstance(check.limit, str) else exact(check.limit, 4)
        status = check.status.upper() if check.status is CheckStatus.FAILS else check.status
        remark = f": {check.remark}" if check.remark else ""
        rows.append([status, f"{check.name}: {exact(check.value, 4)} (limit {limit}){remark}"])
    print_table(rows, flush_left=(0, 1), indent="  ")
    print_lines([f"claims: {study.claim_counts or 'none'}", f"checks: {study.check_counts}"])


def _phase_printer() -> Callable[[str], None]:
    """Return a function that prints the first report of each phase: of those alike up to a colon, but for numbers."""
    reported = set[str]()

    def report(text: str) -> None:
        phase = _NUMBERS.sub("", text.partition(":")[0])
        if phase not in reported:
            reported.add(phase)
            print(text, file=sys.stderr, flush=True)

    return report


@contextmanager
def progress_reporter() -> Iterator[Callable[[str], None]]:
    """Give a function that reports progress on standard error: a spinner on a terminal, else a line for each phase."""
    if not sys.stderr.isatty():
        yield _phase_printer()
        return
    from rich.console import Console

    with Console(stderr=True).status("starting") as status:
        yield status.update


def write_json(path: Path | None, table: Callable[[], Mapping[str, Any]]) -> None:
    """Write `table()` as JSON where a file is wanted.

    Raises:
        InputError: the place cannot be written.
    """
    if path is not None:
        from seatrial.core.values.files import write_atomically
        from seatrial.data.folder.document import strict_json

        write_atomically(path, strict_json(table()).encode())
