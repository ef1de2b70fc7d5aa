"""The page of a campaign: how far it is, errors, coverage, failures, maps over keys; nothing is computed."""

import math
from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.chart import (
    ACCENT,
    INK,
    SECOND,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Panel,
    Points,
    Rectangle,
    Region,
    Rule,
    Shape,
    Stroke,
    tiles,
)
from seatrial.core.figures.panels import heat_map, row_panel
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.campaign import (
    ERROR_BINS,
    ERROR_RANGE,
    CampaignStatus,
    CampaignSummary,
    KeyMap,
    RepeatedCoefficient,
)
from seatrial.core.text.numbers import DASH, duration, exact, fixed, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Severity
from seatrial.reporting.document import chapters_page
from seatrial.reporting.model_chapter import version_section
from seatrial.reporting.section import FirstScreen, KeyFact, Picture, Section, finding_section, plain_table

_HISTOGRAM_CAPTION = (
    "Errors over the Cramér-Rao bound; without a known bound, deviations from the mean over their standard deviation. "
    "The outer bars hold all beyond."
)
_LEVEL = 0.95
"""Probability of the intervals whose coverage is shown, 1."""
_INTERVAL, _LIMIT, _NORMAL = Stroke(ACCENT, 2.0), Stroke(SECOND, 1.2, "5 3"), Stroke(INK, 1.2)  # px, chosen
_SIZE = 3.2  # px, chosen
_COLUMNS, _HEIGHT = 3, 92.0  # histograms side by side and their height [px], chosen
_BAR = "#a9bccb"
_LOWEST_SHARE = 0.5  # lowest share at which the axis of coverage begins, chosen


def sections(summary: CampaignSummary) -> tuple[Section, ...]:
    """Return the chapters of a campaign that have content, in order."""
    repeated = [c for c in summary.coefficients if c.count > 1]
    histograms = (Picture(lambda: svg(error_histograms(repeated)), _HISTOGRAM_CAPTION),) if repeated else ()
    scores = [(s.name, s.unit, str(s.count), *(significant(v, 3) for v in (s.median, s.mean, s.worst)))
              for s in summary.scores]  # fmt: skip
    failures = [(f.example, str(f.count), f.task) for f in summary.failures]
    chapters = (
        coefficient_section(summary.coefficients),
        Section("Distributions of the errors", "distributions", pictures=histograms),
        Section("Scores of held-out runs", "scores",
                table=plain_table(("score", "unit", "runs", "median", "mean", "worst"), scores, flush_left=(0, 1))),
        Section("Over the keys", "maps", parts=tuple(map(_map_section, summary.maps))),
        Section("Failures", "failures",
                table=plain_table(("reason", "tasks", "first one"), failures, flush_left=(0, 2)),
                note="The sentence is that of the first one; others may differ in their numbers."),
        finding_section(summary.findings),
        version_section(summary.versions, {"Processor": ", ".join(summary.processors),
                                           "Linear algebra": "; ".join(summary.linear_algebra)}),
    )  # fmt: skip
    return tuple(chapter for chapter in chapters if chapter)


def html(summary: CampaignSummary) -> str:
    """Return the page as text; chapters without content are left out."""
    heading = summary.question or f"Campaign: {summary.kind}" if summary.kind else "Campaign"
    kind = f"Campaign, {summary.kind}" if summary.kind else "Campaign"
    return chapters_page(kind, heading, first_screen(summary), sections(summary))


def _map_section(one: KeyMap) -> Section:
    rows = f"{one.row_key} from top to bottom, " if one.row_key else ""
    picture = Picture(lambda: svg(_map_chart(one)), f"{rows}{one.column_key} from left to right.")
    return Section(one.quantity, pictures=(picture,))


def first_screen(summary: CampaignSummary) -> FirstScreen:
    """Return what the campaign found and how far it is, with the coverage of its intervals as a picture."""
    *others, verdict = outcome(summary)
    warned = [f.code for f in summary.findings if f.severity is not Severity.INFO]
    facts = [KeyFact(name, text.removesuffix("."), "coefficients" if summary.coefficients else "")
             for name, text in zip(("Tasks", "Errors"), others, strict=False)]  # fmt: skip
    failed = counted(sum(f.count for f in summary.failures), "task")
    facts.append(KeyFact("Failures", failed if summary.failures else "none", "failures" if summary.failures else "",
                         not summary.failures if summary.status.done else None))  # fmt: skip
    facts.append(KeyFact("Warnings", enumeration(warned) or "none", "findings" if summary.findings else "", not warned))
    chart = coverage_chart([c for c in summary.coefficients if c.intervals])
    caption = "Share of the 95 % intervals that hold the truth; bars: what so many intervals can say of that share."
    return FirstScreen(verdict, tuple(facts), Markup(svg(chart)), caption if chart else "")


def outcome(summary: CampaignSummary) -> list[str]:
    """Return the summary in sentences."""
    sentences = [status_sentence(summary.status)]
    ratios = [c.rmse_over_bound for c in summary.coefficients if c.rmse_over_bound is not None]
    if ratios:
        sentences.append(f"Root-mean-square errors are {fixed(min(ratios), 2)} to {fixed(max(ratios), 2)} times the "
                         "Cramér-Rao bound.")  # fmt: skip
    intervals = sum(c.intervals for c in summary.coefficients)
    if intervals:
        share = sum(c.covered for c in summary.coefficients) / intervals
        sentences.append(f"The 95 % intervals hold the truth in {fixed(100 * share, 1)} % of {intervals} cases.")
    return sentences


def status_sentence(status: CampaignStatus) -> str:
    """Return how many tasks are done, failed and left, and how long the rest takes."""
    parts = [f"{status.done} of {counted(status.total, 'task')} done"]
    if status.failed:
        parts.append(f"{status.failed} failed")
    if status.remaining:
        parts.append(f"{status.remaining} left")
    text = ", ".join(parts)
    if status.remaining and status.remaining_seconds is not None:
        text += f": about {duration(status.remaining_seconds)} of one worker"
    return f"{text}."


def coefficient_section(rows: Sequence[RepeatedCoefficient]) -> Section:
    """Return the chapter on the coefficients over all tasks."""
    header = ("", "tasks", "truth", "mean", "std. deviation", "RMSE", "RMSE / bound", "coverage %", "95 % interval")
    note = (
        "RMSE / bound: root mean square of each error over its Cramér-Rao bound. The interval of the coverage is "
        "binomial (Clopper and Pearson 1934)."
    )
    return Section("Coefficients", "coefficients", table=plain_table(header, map(_row, rows)), note=note)


def _row(c: RepeatedCoefficient) -> tuple[str, ...]:
    name = c.name if c.unit == "1" else f"{c.name}, {c.unit}"
    coverage, interval = (DASH, DASH)
    if c.coverage is not None and c.coverage_interval is not None:
        coverage = fixed(100 * c.coverage, 1)
        interval = " to ".join(fixed(100 * end, 1) for end in c.coverage_interval)
    centres, spreads = (c.truth, c.mean), (c.standard_deviation, c.rmse)  # a spread of 200 is uncertain by 5 %
    texts = (significant(v, 4) for v in centres), (significant(v, 2) for v in spreads)
    return name, str(c.count), *texts[0], *texts[1], fixed(c.rmse_over_bound, 2), coverage, interval


def coverage_chart(rows: Sequence[RepeatedCoefficient]) -> Chart | None:
    """Return the share of intervals that hold the truth with its binomial interval; None without intervals."""
    judged = [(c, c.coverage, c.coverage_interval) for c in rows]
    usable = [(c.name, share, ends) for c, share, ends in judged if share is not None and ends is not None]
    if not usable:
        return None
    marks: list[Mark] = [Rule(_LEVEL, _LIMIT, is_vertical=True)]
    for k, (_, share, ends) in enumerate(usable):
        marks.append(Line(np.array(ends), np.full(2, float(k)), _INTERVAL))
        marks.append(Points(np.array([share]), np.array([float(k)]), Marker(Shape.CIRCLE, _SIZE, ACCENT, ACCENT, 0.0)))
    low = max(min([_LOWEST_SHARE, *(ends[0] for _, _, ends in usable)]), 0.0)
    axis = Axis((math.floor(10 * low) / 10, 1.0), "share of the intervals that hold the truth", tick_count=6)
    legend = (LegendEntry("coverage with its 95 % interval", _INTERVAL), LegendEntry("95 %", _LIMIT))
    return Chart("coverage of the intervals", (row_panel([name for name, _, _ in usable], axis, marks),), legend)


def error_histograms(rows: Sequence[RepeatedCoefficient]) -> Chart | None:
    """Return a histogram of each coefficient's errors and the normal distribution of unit variance."""
    usable = [c for c in rows if c.count > 1]
    if not usable:
        return None
    boxes = tiles(len(usable), _COLUMNS, _HEIGHT, left=44.0, gap=56.0)  # px, chosen
    normal = LegendEntry("normal distribution of unit variance", _NORMAL)
    return Chart("errors", tuple(_histogram(c, box) for c, box in zip(usable, boxes, strict=True)), (normal,))


def _histogram(c: RepeatedCoefficient, box: Region) -> Panel:
    width = 2.0 * ERROR_RANGE / ERROR_BINS
    total = max(sum(c.error_counts), 1)
    density = [count / (total * width) for count in c.error_counts]
    bars: list[Mark] = [
        Rectangle(k * width - ERROR_RANGE, 0.0, (k + 1) * width - ERROR_RANGE, height, _BAR)
        for k, height in enumerate(density) if height
    ]  # fmt: skip
    x = np.linspace(-ERROR_RANGE, ERROR_RANGE, 10 * 10 + 1)
    peak = 1.0 / math.sqrt(2.0 * math.pi)
    bars.append(Line(x, peak * np.exp(-0.5 * x**2), _NORMAL))
    top = 1.1 * max(*density, peak)  # free share above the curve, chosen
    unit = "error / bound" if c.rmse_over_bound is not None else "deviation / std. deviation"
    # numbers of ticks that such a small panel has room for, chosen
    return Panel(box, Axis((-ERROR_RANGE, ERROR_RANGE), unit, tick_count=5), Axis((0.0, top), tick_count=3),
                 tuple(bars), c.name)  # fmt: skip


def _map_chart(one: KeyMap) -> Chart | None:
    values = np.array([[math.nan if v is None else v for v in row] for row in one.values], dtype=float)
    rows = [f"{one.row_key} {name}".strip() for name in one.rows] if one.row_key else [one.quantity.split(",")[0]]
    return heat_map(one.quantity, rows, [_short(name) for name in one.columns], values, None)


def _short(name: str) -> str:
    """Return a number with three digits, other text as it is."""
    try:
        return exact(float(name), 3)
    except ValueError:
        return name
