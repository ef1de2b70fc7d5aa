"""Details of a fit on the terminal: windows, estimators and models compared, disturbances, errors samples ahead."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import SEVERITY_MARK
from seatrial.cli.run_errors import ERROR_DIGITS, error_text, label_and_unit
from seatrial.cli.screen import print_heading, print_lines, print_table

if TYPE_CHECKING:
    from seatrial.core.results import (
        Baseline,
        CandidateModel,
        DisturbanceCandidate,
        Fit,
        Prediction,
        ReferenceEstimate,
        WindowScore,
    )

DIGITS = 5  # significant ones of estimates and likelihoods; chosen


def print_method_comparison(fit: "Fit", reference: "ReferenceEstimate") -> None:
    """Print a published method compared with the package's own estimate: coefficients, cost, predictions."""
    from seatrial.core.results.comparison import coefficient_comparison, cost_comparison, inside_own_intervals

    for table in (coefficient_comparison(fit, reference), cost_comparison(fit, reference)):
        last = len(table.header) - 1
        print_table([table.header, *table.rows], flush_left=(0, last) if table.header[last] == "unit" else (0,))
    print_lines([inside_own_intervals(fit, reference)])
    if fit.search is not None:
        stopped = "interrupted: " if fit.search.is_interrupted else ""
        used = "best" if fit.search.fitness == "record" else "first"
        print_lines([f"{stopped}{fit.search.effort}{f'; the {used} is used' if len(fit.search.restarts) > 1 else ''}"])


def print_k_step_errors(fit: "Fit") -> None:
    """Print errors at the shortest and the longest horizon, of the runs held out where there are any."""
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
    print_lines([f"samples ahead {ahead}, {'held-out' if held else 'training'} runs, rms: {', '.join(texts)}"], "  ")


def print_frequency_responses(fit: "Fit") -> None:
    """Print at how many frequencies the model lies within the 95 % region of the records."""
    from seatrial.core.text.numbers import exact

    texts = []
    for r in fit.frequency_responses:
        compared = r.is_compared
        if compared.any():
            low, high = (exact(w, 2) for w in r.excited_range)
            inside = int((r.is_inside & compared).sum())
            texts.append(f"{r.output}/{r.input} {inside} of {int(compared.sum())} ({low} to {high} rad/s)")
    if texts:
        print_lines([f"frequency response, model inside the records' 95 % region: {', '.join(texts)}"], "  ")


def print_windows(p: "Prediction") -> None:
    """Print every score in the windows of a run, and the errors of predictions that need no fit."""
    from seatrial.core.text.words import counted

    for w in p.windows:
        print_lines([f"{counted(w.count, 'window')} of {w.window}"], "  ")
        print_table(_window_rows(w), indent="    ")


def _window_rows(w: "WindowScore") -> list[list[str]]:
    """Scores by channel, and the errors of predictions that need no fit."""
    from seatrial.core.text.numbers import fixed

    rows = [["", "rms", "fit %", "R2", "in band", *(b.name for b in w.baselines)]]
    for name, s in w.scores.items():
        band = "" if s.inside_band is None else f"{100.0 * s.inside_band:.0f} %"
        rivals = [error_text(name, b.scores[name].rms) if name in b.scores else "" for b in w.baselines]
        name_and_unit, error = ", ".join(label_and_unit(name)), error_text(name, s.rms)
        rows.append([name_and_unit, error, fixed(s.fit_percent, 1), fixed(s.r_squared, 3), band, *rivals])
    return rows


def print_model_selection(fit: "Fit") -> None:
    """Print the models of the family with their errors on the runs left out."""
    from seatrial.core.text.numbers import exact

    if not fit.candidate_models:
        return
    is_roll = any(m.roll_deg is not None for m in fit.candidate_models)
    print_heading("Models compared on runs left out")
    rows = [["model", "free", *(["roll deg"] if is_roll else ["heading deg", "position m"]), ""]]
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


def print_baselines(fit: "Fit") -> None:
    """Print how far each estimator is from the fit, or from the truth where it is known, and how it predicts."""
    from seatrial.core.text.numbers import exact

    if not fit.baselines:
        return
    first = fit.baselines[0]
    reference = "errors" if first.error else "from this fit"
    print_heading("Other estimators")
    head = [f"{reference}, %", "median", "worst", *_error_columns(first).values(), "CC u, v, r"]
    rows = [head, *([r.name[:60], *_baseline_cells(r, first, fit)] for r in fit.baselines)]
    print_table(rows, flush_left=(0, len(head) - 1))
    for r in fit.baselines:
        scores = (f"{equation} CC {exact(s.correlation, ERROR_DIGITS)}, explained {exact(s.explained, ERROR_DIGITS)}"
                  for equation, s in r.test.items())  # fmt: skip
        if r.test:
            print_lines([f"test rows, {r.name[:60]}: {'; '.join(scores)}"], "  ")
        print_lines((f"{SEVERITY_MARK[f.severity.value]} [{f.code}] {r.name[:60]}: {f.text}" for f in r.findings), "  ")
    print_lines(["good trajectories and correlations (CC) prove nothing about coefficients"], "  ")


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


def print_disturbances(candidates: "Sequence[DisturbanceCandidate]") -> None:
    """Print the disturbance models that were compared; nothing where none was needed."""
    if not candidates:
        return
    from seatrial.core.text.numbers import fixed, p_value

    rows = [["disturbance", "log-likelihood", "dof", "ratio", "by chance", "innovations", "left out", ""]]
    for c in candidates:
        ratios = [fixed(c.likelihood_ratio, 1), fixed(c.critical_ratio, 1)] if c.critical_ratio > 0.0 else ["", ""]
        verdict = f"{'white' if c.is_white else 'not white'}, {p_value(c.whiteness_p)}"
        left_out = "" if c.left_out_error is None else fixed(c.left_out_error, 2)
        used = "used" if c.is_chosen else ""
        rows.append([c.name, fixed(c.log_likelihood, 1), str(c.degrees_of_freedom), *ratios, verdict, left_out, used])
    print_table(rows, flush_left=(0, 5, 7), indent="  ")  # columns of words: name, verdict, use
