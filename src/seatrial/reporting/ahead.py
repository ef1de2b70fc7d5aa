"""Chapters on predictions some samples ahead and on frequency responses."""

from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit, FrequencyResponse, KStepErrors
from seatrial.core.text.numbers import exact, fixed, significant
from seatrial.core.values import display_unit
from seatrial.core.values.notation import channel_letter
from seatrial.reporting.figures.frequency_chart import frequency_chart
from seatrial.reporting.figures.k_step_chart import k_step_chart
from seatrial.reporting.text_tables import TextTable

_ROLES = {"validation": "held-out runs", "training": "training runs"}


@dataclass(frozen=True)
class Chapter:
    """A figure, empty where there is nothing to draw, and a table."""

    figure: Markup
    table: TextTable


def k_step_chapter(fit: Fit) -> Chapter | None:
    """Return errors over the horizon; None where the fit has none."""
    if not fit.k_step_errors:
        return None
    longest = max(fit.k_step_errors, key=lambda e: len(e.steps))
    dt = longest.seconds[0] / longest.steps[0]
    every = sorted({k for e in fit.k_step_errors for k in e.steps})
    horizons = [f"{k} ({exact(k * dt, 3)} s)" for k in every]
    header = ("Channel", "runs", *horizons)
    rows = [_k_step_row(e, every) for role in _ROLES for e in fit.k_step_errors if e.role == role]
    note = (
        "Root-mean-square error; in brackets that of the last value held. Columns: samples and time ahead. With noise "
        "of the sensors only, every horizon has the error of a simulation."
    )
    table = TextTable("Errors by horizon", header, (False, False, *(True for _ in horizons)), tuple(rows), note)
    return Chapter(Markup(svg(k_step_chart(fit.k_step_errors))), table)


def _k_step_row(e: KStepErrors, every: list[int]) -> tuple[str, ...]:
    factor, unit = display_unit(e.unit)
    texts = {
        k: f"{significant(factor * rms, 3)} ({significant(factor * held, 3)})"
        for k, rms, held in zip(e.steps, e.rms, e.held_rms, strict=True)
    }
    cells = (texts.get(k, "") for k in every)
    return (f"{channel_letter(e.channel)}, {unit}", _ROLES[e.role], *cells)


def frequency_chapter(fit: Fit) -> Chapter | None:
    """Return frequency responses of records and model; None where the fit has none."""
    if not fit.frequency_responses:
        return None
    header = ("Response", "excited, rad/s", "compared", "model inside", "coherence there, mean")
    rows = tuple(_response_row(r) for r in fit.frequency_responses)
    note = (
        "Compared: frequencies at which the input has a thousandth of its largest density or more and the 95 % region "
        "of the records leaves zero out, none where the records do not show the response; chance takes the model out "
        "of the region at one in twenty."
    )
    table = TextTable("Where records and model are compared", header, (False, True, True, True, True), rows, note)
    chart = frequency_chart(fit.frequency_responses)
    return Chapter(Markup("" if chart is None else svg(chart)), table)


def _response_row(r: FrequencyResponse) -> tuple[str, ...]:
    compared = r.is_compared
    low, high = r.excited_range
    coherence = fixed(float(r.coherence[compared].mean()), 2) if compared.any() else ""
    inside = str(int((r.is_inside & compared).sum())) if compared.any() else ""
    name = f"{channel_letter(r.output)} over {channel_letter(r.input)}"
    return name, f"{significant(low, 2)} to {significant(high, 2)}", f"{int(compared.sum())}", inside, coherence
