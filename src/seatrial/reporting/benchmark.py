"""The page of a benchmark: each problem with its methods, targets over evaluations, errors of all runs, tests."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.chart import WIDTH, Axis, Chart, LegendEntry, Panel, Region
from seatrial.core.figures.curves import HEIGHT, LEFT, STROKES
from seatrial.core.figures.marks import GREY, Line, Mark, Rule, Stroke
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.campaign import Benchmark, CheckedClaim, MethodScore, PairedTest, ProblemScore
from seatrial.core.text.numbers import DASH, fixed, p_value, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.reporting.document import page_text
from seatrial.reporting.tables import finding_groups
from seatrial.reporting.text_tables import TextTable

_OTHERS = Stroke(GREY, 1.0)  # px, chosen
_LIMIT = Stroke(GREY, 1.2, "5 3")  # px, chosen
_HEADER = ("method", "median", "rms", "success %", "evaluations", "to success", "coverage %", "time", "")
_NUMERIC = (False, True, True, True, True, True, True, True, False)
_ZERO = 1e-9  # smallest error that is drawn on a logarithmic axis; chosen
_MARGIN = 1.3  # free factor beyond the ends of a logarithmic axis; chosen
HEADINGS = {"problems": "Problems", "findings": "Findings", "methods": "Methods",
            "provenance": "Provenance"}  # fmt: skip
TABLE_NOTE = (
    "Median and rms: errors in the unit of the problem. Evaluations: median of a run; to success: those of all runs "
    "over the number of successes. The median counts runs without an answer as the worst, the rms leaves them out. "
    "Coverage: share of the method's 95 % intervals that hold the truth. Time: of a run, in those of random search, "
    "where that took part; it varies by machine and load. A dash: none, as of evaluations without the fitness."
)


@dataclass(frozen=True)
class ProblemPart:
    """What the page shows of one problem."""

    score: ProblemScore
    facts: tuple[tuple[str, str], ...]
    table: TextTable
    targets: Markup
    waterfall: Markup
    tests: TextTable | None
    claims: TextTable | None


def html(result: Benchmark) -> str:
    """Return the page as text."""
    content: dict[str, object] = {"findings": finding_groups(result.findings)}
    context = {
        **content,
        "titles": {key: title for key, title in HEADINGS.items() if content.get(key, True)},
        "benchmark": result,
        "outcome": outcome(result),
        "heading_counts": f"{counted(len(result.problems), 'problem')}, {counted(len(result.methods), 'method')}",
        "parts": [problem_part(score, result.targets) for score in result.problems],
        "note": TABLE_NOTE,
        "method_table": TextTable(
            "As they were entered", ("method", "source", ""), (False, False, False),
            tuple((m.name, m.source, "" if m.is_built_in else m.digest[:16]) for m in result.methods),  # 16 digits
            "The last column has the first digits of the SHA-256 of a method's own file.",
        ),
    }  # fmt: skip
    return page_text("benchmark.html", context)


def outcome(result: Benchmark) -> list[str]:
    """Return the summary in sentences: each entered method, or else the best one of each problem."""
    runs = f"{counted(result.status.total, 'run')}, {result.placement}."
    entered = [m.name for m in result.methods if not m.is_built_in]
    if entered:
        return [runs, *(_entered_sentence(name, result) for name in entered)]
    best = [f"{p.name}: {p.methods[0].method}" for p in result.problems if p.methods]
    return [runs, f"Smallest median error: {enumeration(best)}."]


def _entered_sentence(name: str, result: Benchmark) -> str:
    """What the tests say of one method, over all problems."""
    tests = [t for p in result.problems for t in p.tests if t.method == name]
    better, worse = (sum(t.verdict == word for t in tests) for word in ("better", "worse"))
    own = [m for p in result.problems for m in p.methods if m.method == name]
    successes, total = sum(m.successes for m in own), sum(m.runs + m.failures for m in own)
    failures, outside = sum(m.failures for m in own), sum(m.outside for m in own)
    failed = next((m.failure for m in own if m.failure), "")
    text = (
        f"{name} succeeds in {successes} of {counted(total, 'run')}; in {counted(len(tests), 'comparison')} with "
        f"built-in methods it is better in {better}, worse in {worse}, and no difference shows in "
        f"{len(tests) - better - worse}."
    )
    if failed:
        text = f"{text} Without an answer {failures}: {failed}."
    return f"{text} Answers outside the box: {outside}." if outside else text


def problem_part(score: ProblemScore, targets: Sequence[float]) -> ProblemPart:
    """Return what the page shows of a problem."""
    facts = (
        ("Source", score.source), ("Noise", score.noise), ("Unknowns", ", ".join(score.unknowns)),
        ("Budget", f"{counted(score.budget, 'evaluation')} a run"), ("Error of 1", score.error_unit),
        ("Success", f"error of at most {significant(score.success_limit, 1)}"),
    )  # fmt: skip
    tests = comparison_table(score.tests) if score.tests else None
    limits = ", ".join(f"{factor * score.success_limit:g}" for factor in targets)
    return ProblemPart(
        score, (*facts, ("Targets", f"errors of {limits}")), method_table(score), Markup(svg(target_chart(score))),
        Markup(svg(waterfall_chart(score))), tests, claim_table(score.claims) if score.claims else None,
    )  # fmt: skip


def method_table(score: ProblemScore) -> TextTable:
    """Return all methods on a problem, the best median first."""
    return TextTable("Methods", _HEADER, _NUMERIC, tuple(_row(m) for m in score.methods), "")


def _row(m: MethodScore) -> tuple[str, ...]:
    coverage = DASH if m.coverage is None else fixed(100.0 * m.coverage, 1)
    return (
        m.method if m.is_built_in else f"{m.method} (entered)", _error(m.median), _error(m.rms),
        fixed(100.0 * m.success_share, 0), fixed(m.evaluations or None, 0), fixed(m.evaluations_to_success or None, 0),
        coverage,
        significant(m.time_ratio, 2), "; ".join(_remarks(m)),
    )  # fmt: skip


def _error(value: float | None) -> str:
    """An error as text; infinite ones are answers that cannot be evaluated."""
    if value is not None and math.isinf(value):
        return "∞"
    return significant(value, 3)


def _remarks(m: MethodScore) -> list[str]:
    """What else is to be said of a method: runs without an answer, outside the box, ended by their budget."""
    remarks = [f"{m.failures} without an answer: {m.failure}"] if m.failures else []
    remarks += [f"{m.outside} outside the box"] if m.outside else []
    infinite = sum(math.isinf(error) for error in m.errors)
    return [*remarks, *([f"{infinite} answers cannot be evaluated"] if infinite else [])]


def comparison_table(tests: Sequence[PairedTest]) -> TextTable:
    """Return the paired tests."""
    rows = tuple(
        (t.method, t.against, str(t.smaller), str(t.larger), p_value(t.p_adjusted).removeprefix("p "), t.verdict)
        for t in tests
    )
    return TextTable(
        "Paired comparisons", ("method", "against", "smaller error", "larger error", "p, corrected", ""),
        (False, False, True, True, True, False), rows,
        "Sign tests on the same draws, corrected for all comparisons of this page (Holm 1979).",
    )  # fmt: skip


def claim_table(claims: Sequence[CheckedClaim]) -> TextTable:
    """Return what the problem's paper says, and what the draws show."""
    rows = tuple(
        (c.text, str(c.test.smaller), str(c.test.larger), p_value(c.test.p_adjusted).removeprefix("p "), c.verdict)
        for c in claims
    )
    return TextTable(
        "Claims of the paper", ("claim", "draws for it", "against it", "p, corrected", ""),
        (False, True, True, True, False), rows,
        "Contradicted: the other method is significantly better here. Not shown: they do not differ significantly. "
        "Corrected for all claims of this page.",
    )  # fmt: skip


def target_chart(score: ProblemScore) -> Chart | None:
    """Return the share of targets met over the evaluations of a run (Hansen et al. 2016, COCO)."""
    met = [m for m in score.methods if m.targets.evaluations]
    if not met:
        return None
    first = min(m.targets.evaluations[0] for m in met)
    ends = (max(first, 1) / _MARGIN, max(_MARGIN * score.budget, *(m.targets.evaluations[-1] for m in met)))
    curves = []
    for m in met:
        counts = np.array(m.targets.evaluations, dtype=np.float64)
        x = np.repeat([*counts, ends[1]], 2)[:-1]
        y = np.repeat(np.arange(len(counts) + 1), 2)[1:] / m.targets.total
        curves.append((m, np.array([counts[0], *x[1:]]), np.array([0.0, *y[1:]])))
    axis = Axis(ends, "evaluations of a run", is_logarithmic=True, tick_count=6)  # ticks, chosen
    return _chart("targets met", score, curves, axis, Axis((0.0, 1.0), "share of runs and targets met"))


def waterfall_chart(score: ProblemScore) -> Chart | None:
    """Return the errors of all runs of each method in order of size."""
    finite = {m.method: np.array([e for e in m.errors if math.isfinite(e)]) for m in score.methods}
    some = [m for m in score.methods if finite[m.method].size]
    if not some:
        return None
    values = np.maximum(np.concatenate([finite[m.method] for m in some]), _ZERO)
    ends = (min(float(values.min()), score.success_limit) / _MARGIN,
            max(float(values.max()), score.success_limit) * _MARGIN)  # fmt: skip
    runs = max(m.runs + m.failures for m in some)
    curves = [(m, np.arange(1.0, len(finite[m.method]) + 1.0), np.maximum(finite[m.method], _ZERO)) for m in some]
    axis = Axis((0.5, runs + 0.5), "runs in order of their error", tick_count=7)  # ticks, chosen
    marks = (Rule(score.success_limit, _LIMIT),)
    return _chart("errors of all runs", score, curves, axis, Axis(ends, "error", is_logarithmic=True), marks)


def _chart(
    title: str, score: ProblemScore, curves: Sequence[tuple[MethodScore, np.ndarray, np.ndarray]], x: Axis, y: Axis,
    marks: tuple[Mark, ...] = (),
) -> Chart:  # fmt: skip
    """Curves of the entered methods and of the best others in styles of their own, the rest in grey."""
    order = sorted(score.methods, key=lambda m: m.is_built_in)
    named = {m.method: STROKES[k] for k, m in enumerate(order[: len(STROKES)])}
    lines = [Line(xs, ys, named.get(m.method, _OTHERS)) for m, xs, ys in curves]
    lines.sort(key=lambda line: line.stroke is not _OTHERS)
    drawn_names = [m.method for m, _, _ in curves]
    legend = [LegendEntry(name, stroke) for name, stroke in named.items() if name in drawn_names]
    legend += [LegendEntry("others", _OTHERS)] if len(drawn_names) > len(legend) else []
    legend += [LegendEntry("limit of a success", _LIMIT)] if marks else []
    box = Region(LEFT, 8.0, WIDTH - LEFT - 24.0, HEIGHT)  # px, chosen
    return Chart(title, (Panel(box, x, y, (*marks, *lines)),), tuple(legend))
