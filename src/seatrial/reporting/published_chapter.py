"""The chapter on a published method: its values set beside the package's own estimate, and what its search did."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from seatrial.core.figures.chart import Chart
from seatrial.core.figures.panels import NamedCurve, curves_chart
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit, ReferenceEstimate, Search, SearchTrack
from seatrial.core.results.comparison import (
    ESTIMATE_DIGITS,
    ComparisonTable,
    coefficient_comparison,
    cost_comparison,
    inside_own_intervals,
)
from seatrial.core.text.numbers import exact
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Array
from seatrial.reporting.figures.search_charts import (
    restart_chart,
    trace_charts,
    track_charts,
    value_charts,
    waterfall_chart,
)
from seatrial.reporting.section import Picture, Section, TextTable, plain_table

_EFFORT = (
    "Evaluations of the package’s estimate are those under its final criterion, each with exact slopes; its processor "
    "time holds everything from the start to the intervals."
)


_CONVERGENCE = "Best fitness after each iteration of each restart (logarithm to base 10)."


def published_section(fit: Fit) -> Section:
    """Return the chapter on a published method; empty where the fit is the package's own estimate."""
    reference = fit.reference
    if reference is None:
        return _section_alone(fit)
    scatter = " Scatter: standard deviation over the restarts." if fit.search and fit.search.scatter else ""
    pictures = _search_pictures(fit.search, reference) if fit.search else ()
    if fit.search and fit.search.track:
        pictures = (*_track_pictures(fit.search.track, reference, fit.method.name), *pictures)
    return Section(
        "The published method and the package’s own estimate",
        "published",
        tuple(_sentences(fit, reference)),
        parts=(
            Section(
                "",
                table=_table(coefficient_comparison(fit, reference)),
                note=f"Difference: of the method from the package’s estimate, in its standard errors.{scatter}",
            ),
            Section(
                "Effort, and errors of simulated runs", table=_table(cost_comparison(fit, reference)), note=_EFFORT
            ),
            Section("", pictures=pictures),
        ),
    )


def _section_alone(fit: Fit) -> Section:
    """The chapter of a published method beside which nothing else was estimated."""
    if not fit.coefficients or fit.method.gives_intervals:
        return Section("")
    rows = [
        (c.name, exact(c.estimate, ESTIMATE_DIGITS), c.unit if c.unit != "1" else "")
        for c in fit.coefficients
        if not c.fixed
    ]
    pictures = _pictures([(_convergence_chart(fit.search), _CONVERGENCE)]) if fit.search else ()
    return Section(
        "The published method",
        "published",
        (
            *_method_sentences(fit), "The package’s own estimate was not made, as own_estimate says: nothing shows "
            "how far these values can be trusted.", *_search_sentences(fit),
        ),
        parts=(
            Section("", table=plain_table(("coefficient", fit.method.name, "unit"), rows, flush_left=[0, 2])),
            Section("", pictures=pictures),
        ),
    )  # fmt: skip


def _method_sentences(fit: Fit) -> list[str]:
    return [f"{fit.method.criterion[:1].upper()}{fit.method.criterion[1:]}. The method gives no intervals."]


def _search_sentences(fit: Fit) -> list[str]:
    """Where the search ended, and whether it did."""
    search = fit.search
    if search is None:
        return []
    text = []
    ends = [name for name, value in search.restarts[search.used].values.items() if value in search.bounds[name]]
    if ends:
        text.append(f"On an end of the range searched: {enumeration(ends)}.")
    if search.is_interrupted:
        text.append(f"The search was interrupted; {counted(len(search.restarts), 'restart')} are shown.")
    return text


def _sentences(fit: Fit, reference: ReferenceEstimate) -> list[str]:
    text = [
        *_method_sentences(fit),
        f"{inside_own_intervals(fit, reference)}, the package’s own estimate.",
    ]
    search = fit.search
    if search is None:
        return text
    if reference.record_rms is not None:
        level = search.restarts[search.used].record_rms
        text.append(
            f"Over the whole record it leaves a weighted rms of {exact(level, 5)}, the package’s own estimate "
            f"{exact(reference.record_rms, 5)}, after {search.evaluations} and {reference.evaluations} evaluations."
        )
    return [*text, *_search_sentences(fit)]


def _table(table: ComparisonTable) -> TextTable:
    words = [k for k, name in enumerate(table.header) if k == 0 or name == "unit"]
    return plain_table(table.header, table.rows, flush_left=words)


def _search_pictures(search: Search, reference: ReferenceEstimate) -> tuple[Picture, ...]:
    by_samples = search.fitness == "sample"
    convergence = _CONVERGENCE
    if by_samples:
        convergence += " Each iteration judges by a sample of its own, so that the best may rise."
    drawn: list[tuple[Chart | None, str]] = [(_convergence_chart(search), convergence)]
    if search.track:
        return _pictures(drawn)
    drawn.append(
        (
            waterfall_chart(search, reference),
            "Weighted rms over the whole record at the end of each restart, "
            "in order of size, and of the package’s own estimate.",
        )
    )
    free = [c for c in reference.coefficients if not c.fixed]
    marks = ["bars: its 95 % intervals"] if any(c.lower is not None for c in free) else []
    marks += ["diamonds: known values"] if any(c.truth is not None for c in free) else []
    values = f"Values of each restart less the package’s own estimate, per cent of it{'; ' if marks else ''}"
    drawn.append((restart_chart(search, reference), f"{values}{', '.join(marks)}."))
    if by_samples:
        caption = "Best value after each iteration of the restart that is used."
        drawn += [(chart, caption) for chart in trace_charts(search, reference)]
    return _pictures(drawn)


def _track_pictures(track: SearchTrack, reference: ReferenceEstimate, method: str) -> tuple[Picture, ...]:
    motion = "Recorded, and simulated with the coefficients that the search and the package’s own follower had at each "
    motion += "moment."
    values = "Coefficient of each moment, by the search and by the package’s own follower."
    drawn: list[tuple[Chart | None, str]] = [(chart, motion) for chart in track_charts(track, method)]
    return _pictures([*drawn, *((chart, values) for chart in value_charts(track, reference, method))])


def _pictures(captioned: Sequence[tuple[Chart | None, str]]) -> tuple[Picture, ...]:
    return tuple(Picture(partial(svg, chart), caption) for chart, caption in captioned if chart is not None)


def _convergence_chart(search: Search) -> Chart | None:
    curves = [
        NamedCurve(f"restart {k + 1}", *_iterations(np.array(one.history))) for k, one in enumerate(search.restarts)
    ]
    return curves_chart("convergence of the search", curves, "iteration", "log10 of the best fitness")


def _iterations(history: Array) -> tuple[Array, Array]:
    """Numbers of the iterations from 1, and the logarithms of positive, finite fitness."""
    usable = np.isfinite(history) & (history > 0.0)
    return np.arange(1.0, len(history) + 1.0)[usable], np.log10(history[usable])
