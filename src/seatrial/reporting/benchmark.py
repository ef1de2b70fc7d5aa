"""The page of a benchmark: each problem with its methods, targets over evaluations, errors of all runs, tests."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import GREY, WIDTH, Axis, Chart, LegendEntry, Line, Mark, Panel, Region, Rule, Stroke
from seatrial.core.figures.panels import HEIGHT, LEFT, STROKES
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.campaign import Benchmark, CheckedClaim, MethodScore, PairedTest, ProblemScore
from seatrial.core.text.numbers import DASH, fixed, p_value, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.reporting.document import chapters_page
from seatrial.reporting.model_chapter import version_section
from seatrial.reporting.section import (
    FirstScreen,
    KeyFact,
    Picture,
    Section,
    TextTable,
    fact_table,
    finding_section,
    plain_table,
)

_OTHERS = Stroke(GREY, 1.0)  # px, chosen
_LIMIT = Stroke(GREY, 1.2, "5 3")  # px, chosen
_HEADER = ("method", "median", "rms", "success %", "evaluations", "to success", "coverage %", "time", "")
_ZERO = 1e-9  # smallest error that is drawn on a logarithmic axis; chosen
_MARGIN = 1.3  # free factor beyond the ends of a logarithmic axis; chosen
_DIGEST = 16  # digits of a hash that are shown
TABLE_NOTE = (
    "Median and rms: errors in the unit of the problem. Evaluations: median of a run; to success: those of all runs "
    "over the number of successes. The median counts runs without an answer as the worst, the rms leaves them out. "
    "Coverage: share of the method's 95 % intervals that hold the truth. Time: of a run, in those of random search, "
    "where that took part; it varies by machine and load. A dash: none, as of evaluations without the fitness."
)


def sections(result: Benchmark) -> tuple[Section, ...]:
    """Return the chapters of a benchmark that have content, in order."""
    problems = tuple(problem_section(score, result.targets) for score in result.problems)
    sources = [(m.name, m.source, "" if m.is_built_in else m.digest[:_DIGEST]) for m in result.methods]
    chapters = (
        Section("Problems", "problems", note=TABLE_NOTE, parts=problems),
        finding_section(result.findings),
        Section("Methods", "methods", table=plain_table(("method", "source", ""), sources, flush_left=(0, 1, 2)),
                note="The last column has the first digits of the SHA-256 of a method's own file."),
        version_section(result.versions, {"Processor": ", ".join(result.processors), "To cite": result.citation}),
    )  # fmt: skip
    return tuple(chapter for chapter in chapters if chapter)


def html(result: Benchmark) -> str:
    """Return the page as text."""
    extent, *verdicts = outcome(result)
    counts = f"{counted(len(result.problems), 'problem')}, {counted(len(result.methods), 'method')}"
    heading = f"{counts}, seeds {result.seeds[0]} to {result.seeds[1]}"
    screen = FirstScreen(" ".join(verdicts), (KeyFact("Extent", extent.removesuffix(".")),))
    return chapters_page("Benchmark", heading, screen, sections(result), title="Benchmark of methods")


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


def problem_section(score: ProblemScore, targets: Sequence[float]) -> Section:
    """Return what the page shows of a problem."""
    limits = ", ".join(f"{factor * score.success_limit:g}" for factor in targets)
    facts = {
        "Source": score.source, "Noise": score.noise, "Unknowns": ", ".join(score.unknowns),
        "Budget": f"{counted(score.budget, 'evaluation')} a run", "Error of 1": score.error_unit,
        "Success": f"error of at most {significant(score.success_limit, 1)}", "Targets": f"errors of {limits}",
    }  # fmt: skip
    pictures = (
        Picture(lambda: svg(target_chart(score)),
                "Share of all runs and targets that a method has met after so many evaluations."),
        Picture(lambda: svg(waterfall_chart(score)), "Errors of the answers, each method's in order of size."),
    )  # fmt: skip
    return Section(
        f"{score.name}, version {score.version}: {score.title}",
        score.name,
        table=fact_table(facts),
        parts=(
            Section("Methods compared", table=method_table(score), pictures=pictures),
            claim_section(score.claims),
            comparison_section(score.tests),
        ),
    )


def method_table(score: ProblemScore) -> TextTable:
    """Return all methods on a problem, the best median first."""
    return plain_table(_HEADER, map(_row, score.methods), flush_left=(0, -1))


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


def comparison_section(tests: Sequence[PairedTest]) -> Section:
    """Return the paired tests."""
    rows = [
        (t.method, t.against, str(t.smaller), str(t.larger), p_value(t.p_adjusted).removeprefix("p "), t.verdict)
        for t in tests
    ]
    header = ("method", "against", "smaller error", "larger error", "p, corrected", "")
    return Section(
        f"Paired comparisons ({len(tests)})",
        table=plain_table(header, rows, flush_left=(0, 1, -1)),
        note="Sign tests on the same draws, corrected for all comparisons of this page (Holm 1979)." if tests else "",
        is_folded=True,
    )


def claim_section(claims: Sequence[CheckedClaim]) -> Section:
    """Return what the problem's paper says, and what the draws show."""
    rows = [
        (c.text, str(c.test.smaller), str(c.test.larger), p_value(c.test.p_adjusted).removeprefix("p "), c.verdict)
        for c in claims
    ]
    return Section(
        "Claims of the paper",
        table=plain_table(("claim", "draws for it", "against it", "p, corrected", ""), rows, flush_left=(0, -1)),
        note="Contradicted: the other method is significantly better here. Not shown: they do not differ "
        "significantly. Corrected for all claims of this page.",
    )


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
