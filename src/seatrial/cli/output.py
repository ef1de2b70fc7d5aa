"""What the commands print and write: findings, fits and studies as text, progress, JSON."""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seatrial.core.results import Baseline, Design, Extrapolation, Fit, ManoeuvrePrecision, Prediction, Study
    from seatrial.core.values import Finding

EXTRAPOLATION_LIMIT = 1.2
EXTRAPOLATION_NOTE = ": beyond the training runs, read its intervals as lower limits"
MAX_ORDERS_PRINTED = 8
SEVERITY_MARK = {"error": "ERROR  ", "warning": "warning", "info": "note   "}


def print_findings(findings: "tuple[Finding, ...]", per_code: int) -> None:
    """Findings by kind, errors first; of each kind the first few."""
    order = list(SEVERITY_MARK)
    kinds = {
        (f.severity.value, f.code): [g for g in findings if g.code == f.code and g.severity is f.severity]
        for f in findings
    }
    for (severity, code), alike in sorted(kinds.items(), key=lambda item: order.index(item[0][0])):
        for finding in alike[:per_code]:
            print(f"{SEVERITY_MARK[severity]} [{code}] {finding.text}")
        if len(alike) > per_code:
            print(f"        ... and {len(alike) - per_code} more of this kind; --all shows them")
        if alike[0].advice:
            print(f"        advice: {alike[0].advice}")
    errors = sum(finding.severity.value == "error" for finding in findings)
    print(f"{len(findings)} finding{'s' * (len(findings) != 1)}, {errors} of them error{'s' * (errors != 1)}")


def print_fit(fit: "Fit") -> None:
    """Free coefficients, how well the runs that were kept out are predicted, and what the records cannot tell."""
    with_truth = any(c.truth is not None for c in fit.coefficients)
    print(
        f"{'coefficient':14s} {'estimate':>12s} {'std. error':>11s} {'95 % from':>12s} {'to':>12s}"
        + (f" {'truth':>12s}" if with_truth else "")
    )
    for c in fit.coefficients:
        if not c.fixed:
            error = "" if c.standard_error is None else f"{c.standard_error:11.2g}"
            lower, upper = ("" if end is None else f"{end:12.5g}" for end in (c.lower, c.upper))
            truth = f" {c.truth:12.5g}" if c.truth is not None else ""
            unit = c.unit if c.unit != "1" else ""
            print(f"{c.name:14s} {c.estimate:12.5g} {error:>11s} {lower:>12s} {upper:>12s}{truth} {unit}".rstrip())
    for p in fit.validation:
        _print_prediction(p)
    _print_model_selection(fit)
    _print_baselines(fit)
    _print_identifiability(fit)
    print(f"intervals: {fit.method.intervals}")
    print(f"{fit.method.criterion}; {fit.elapsed_s:.1f} s")


def _print_prediction(p: "Prediction") -> None:
    errors = ", ".join(f"{name} {value:.3g}" for name, value in p.rms.items())
    print(f"validation {p.record}: rms {errors}")
    if p.noise_floor:
        print("  process noise alone: " + ", ".join(f"{name} {value:.3g}" for name, value in p.noise_floor.items()))
    if p.tied_spread:
        print("  tied models differ by: " + ", ".join(f"{name} {value:.3g}" for name, value in p.tied_spread.items()))
    if p.extrapolation is not None:
        print(
            f"  extrapolation index {p.extrapolation.index:.2f}"
            + (EXTRAPOLATION_NOTE if p.extrapolation.index > EXTRAPOLATION_LIMIT else "")
        )
    for name, m in p.measures.items():
        if m.simulated is not None and m.lower is not None and m.upper is not None:
            measured = "" if m.measured is None else f", measured {m.measured:.4g}"
            print(f"  {name}: {m.simulated:.4g} [{m.lower:.4g}, {m.upper:.4g}]{measured}")


def _print_model_selection(fit: "Fit") -> None:
    rolls = any(m.roll_deg is not None for m in fit.candidate_models)
    if fit.candidate_models:
        heads = f"{'roll deg':>24s}" if rolls else f"{'heading deg':>12s} {'position m':>11s}"
        print(f"{'family, runs left out':42s} {'free':>5s} {heads}")
    for m in fit.candidate_models:
        shown = (m.roll_deg,) if rolls else (m.heading_deg, m.position_m)
        scores = "  ".join("-" if x is None else f"{x:.3g}" for x in shown)
        marks = ", ".join(
            word for word, holds in (("used", m.is_chosen), ("tied", m.is_tied), (m.note, m.note)) if holds
        )
        print(f"{m.name:42s} {m.free_count:5d} {scores:>24s}  {marks}".rstrip())


def _print_baselines(fit: "Fit") -> None:
    """How far each estimator is from the fit, or from the truth where it is known, and how it predicts."""
    if not fit.baselines:
        return
    first = fit.baselines[0]
    what = "errors, %" if first.error else "from this fit, %"
    heads = f"{'worst':>8s} {'heading deg':>12s} {'position m':>11s}  CC u, v, r"
    print(f"{'other estimators':46s} {what:>17s}: median {heads}")
    for r in fit.baselines:
        print(f"{r.name[:60]:62s} {_coefficient_errors(r, first)} {_prediction_errors(r, fit)}".rstrip())
        for finding in r.findings:
            print(f"  {SEVERITY_MARK[finding.severity.value]} [{finding.code}] {finding.text}")
    print("  good trajectories and correlations (CC) prove nothing about coefficients")


def _coefficient_errors(baseline: "Baseline", reference: "Baseline") -> str:
    from statistics import median

    sizes = [100.0 * abs(away) for away in baseline.relative_deviation(reference).values()]
    return f"{median(sizes):10.3g} {max(sizes):8.3g}" if sizes else " " * 19


def _prediction_errors(baseline: "Baseline", fit: "Fit") -> str:
    """Errors and correlations of the runs held out, or of the training runs where there are none; or why none."""
    if baseline.note:
        return f"failed: {baseline.note}"
    if baseline.diverged:
        return f"diverges in {len(baseline.diverged)} of {len(fit.predictions)} runs, {baseline.diverged[0]} first"
    runs = baseline.validation if fit.validation else baseline.training
    cells = [f"{runs.rms[key]:.3g}" if key in runs.rms else "-" for key in ("psi_deg", "position_m")]
    return f"{cells[0]:>12s} {cells[1]:>11s}  {', '.join(f'{cc:.3f}' for cc in runs.correlation.values())}"


def _print_identifiability(fit: "Fit") -> None:
    known, disturbance = fit.identifiability, fit.noise_model
    if known is not None:
        free = sum(not c.fixed for c in fit.coefficients)
        print(f"the records determine about {known.effective_parameters:.0f} of {free} free coefficients")
        for symmetry in known.structural:
            print(f"  cannot be told: {symmetry.text}")
    if disturbance is not None and disturbance.text:
        print(f"{disturbance.method}: {disturbance.text}")


def print_measures(
    measures: Mapping[str, float],
    intervals: Mapping[str, tuple[float, float]],
    extrapolation: "Extrapolation | None",
) -> None:
    """Measures of a simulated manoeuvre with their 95 % intervals, and how far it leaves the training runs."""
    for name, value in measures.items():
        lower, upper = intervals.get(name, (None, None))
        print(f"  {name:28s} {value:10.4g}" + ("" if lower is None else f"  [{lower:.4g}, {upper:.4g}]"))
    if extrapolation is not None:
        print(
            f"  extrapolation index {extrapolation.index:.2f}"
            + (EXTRAPOLATION_NOTE if extrapolation.index > EXTRAPOLATION_LIMIT else "")
        )


def print_study(study: "Study") -> None:
    """Claims with their verdicts, then checks with their limits."""
    for claim in study.claims:
        print(f"  {claim.verdict:10s} {claim.claim}: {claim.evidence}")
    for check in study.checks:
        limit = check.limit if isinstance(check.limit, str) else f"{check.limit:.4g}"
        print(f"  {'holds' if check.holds else 'FAILS':10s} {check.name}: {check.value:.4g} (limit {limit})")


def print_design(design: "Design") -> None:
    """What the manoeuvre found is worth beside the standard ones, and how the helmsman's table begins."""
    from seatrial.core.results.design_ranking import has_track, ranked_baselines

    track = f" {'drift deg':>10s} {'room m':>8s}" if has_track(design) else ""
    print(f"{'relative std. error, %':24s} {'worst':>8s} {'mean':>8s} {'drawn':>9s}{track}")
    for worth in (design.designed, *ranked_baselines(design)):
        _print_manoeuvre(worth, design)
    known = design.confirmation
    if known is not None:
        error, bound = (100.0 * max(values) for values in (known.error, known.bound))
        fits = f"{known.converged_runs} of {known.runs} fits of simulated trials succeed"
        print(f"{fits}: worst error over them {error:.3g} %, {bound:.3g} % foretold" if known.converged_runs else fits)
    for finding in design.findings:
        print(f"{SEVERITY_MARK[finding.severity.value]} [{finding.code}] {finding.text}: {finding.advice}")
    _print_orders(design)
    print(f"{design.solution.evaluations} manoeuvres tried; {design.elapsed_s:.1f} s")


def _print_manoeuvre(manoeuvre: "ManoeuvrePrecision", design: "Design") -> None:
    import math

    from seatrial.core.results.design_ranking import has_track, is_within_limits

    drawn = manoeuvre.worst_sampled_error
    cells = [f"{100.0 * value:8.3g}" for value in (manoeuvre.worst, manoeuvre.mean)]
    cells.append(f"{'' if math.isnan(drawn) else f'{100.0 * drawn:.3g}':>9s}")
    cells += [f"{math.degrees(manoeuvre.drift):10.3g}", f"{manoeuvre.distance:8.4g}"] if has_track(design) else []
    lost = manoeuvre.diverged
    notes = [f"{lost} ship{'s' * (lost != 1)} lost"] if lost else []
    notes += [] if is_within_limits(manoeuvre, design.limits) else ["leaves the limits"]
    print(f"{manoeuvre.name:24s} {' '.join(cells)}  {', '.join(notes)}".rstrip())


def _print_orders(design: "Design") -> None:
    from seatrial.data.folder.orders import order_cells, order_headings

    lines = [
        order_headings(design.actuators),
        *(order_cells(order, design.actuators) for order in design.orders[:MAX_ORDERS_PRINTED]),
    ]
    widths = [len(head) + 3 for head in lines[0]]
    for line in lines:
        print("".join(f"{cell:>{width}s}" for cell, width in zip(line, widths, strict=True)))
    if len(design.orders) > MAX_ORDERS_PRINTED:
        print(f"  ... and {len(design.orders) - MAX_ORDERS_PRINTED} more orders in orders.csv")


@contextmanager
def progress_reporter() -> Iterator[Callable[[str], None]]:
    """A spinner on a terminal, plain lines otherwise; both on standard error."""
    if not sys.stderr.isatty():
        yield lambda text: print(text, file=sys.stderr, flush=True)
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
