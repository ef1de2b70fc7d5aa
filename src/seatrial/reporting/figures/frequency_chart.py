"""Frequency responses: magnitude and phase of the records with their 95 % region, and of the model."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    INK,
    SECOND,
    WIDTH,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Panel,
    Points,
    Region,
    Shape,
    Stroke,
    span,
)
from seatrial.core.results.ship_motions import FrequencyResponse
from seatrial.core.values import display_unit
from seatrial.core.values.notation import channel_letter, channel_unit

MAX_PAIRS, COLUMNS = 6, 2  # pairs drawn at most, and side by side
MAGNITUDE_HEIGHT, PHASE_HEIGHT, GAP, ROW_GAP = 120.0, 80.0, 8.0, 62.0  # px, chosen
LEFT, RIGHT, TOP = 62.0, 10.0, 22.0  # px, chosen
MODEL, BAR = Stroke(ACCENT, 1.8), Stroke(INK, 1.0)  # px, chosen
RECORDS = Marker(Shape.CIRCLE, 2.4, INK, INK, 0.8)  # px, chosen
OUTSIDE = Marker(Shape.CIRCLE, 2.8, SECOND, "#ffffff", 1.4)  # px, chosen
_DEGREES = float(np.degrees(1.0))
# share that stays free at the ends of the logarithmic axes
_FREE = 1.2


def frequency_chart(responses: Sequence[FrequencyResponse]) -> Chart | None:
    """Return magnitude over phase for the pairs that agree best with a linear response; None where there is none."""
    usable = [r for r in responses if r.is_compared.any()]
    usable = sorted(usable, key=lambda r: -int(r.is_compared.sum()))[:MAX_PAIRS]
    if not usable:
        return None
    width = WIDTH / COLUMNS
    panels: list[Panel] = []
    for k, r in enumerate(sorted(usable, key=responses.index)):
        top = TOP + (k // COLUMNS) * (MAGNITUDE_HEIGHT + GAP + PHASE_HEIGHT + ROW_GAP)
        left = (k % COLUMNS) * width + LEFT
        above = Region(left, top, width - LEFT - RIGHT, MAGNITUDE_HEIGHT)
        below = Region(left, above.bottom + GAP, above.width, PHASE_HEIGHT)
        panels += [_magnitude(r, above), _phase(r, below)]
    legend = (
        LegendEntry("records, 95 %", RECORDS),
        LegendEntry("the model leaves that region", OUTSIDE),
        LegendEntry("model, simulated with the same inputs", MODEL),
    )
    return Chart("frequency responses of records and model", tuple(panels), legend)


def _magnitude(r: FrequencyResponse, box: Region) -> Panel:
    factor, unit = _display(r)
    size, model, half = factor * np.abs(r.measured), factor * np.abs(r.simulated), factor * r.radius
    shown = r.is_compared
    bars = np.concatenate([(size - half)[shown], (size + half)[shown], model[np.array(r.excited)]])
    positive = bars[bars > 0.0]
    y = Axis((float(positive.min()) / _FREE, float(positive.max()) * _FREE), unit, is_logarithmic=True, tick_count=4)
    marks = (*_records(r, size, half), Line(*_model_line(r, model), MODEL))
    title = f"{channel_letter(r.output)} over {channel_letter(r.input)}"
    return Panel(box, _omega_axis(r, ""), y, marks, title)


def _phase(r: FrequencyResponse, box: Region) -> Panel:
    excited = np.array(r.excited)
    model = np.full(len(r.omega), np.nan)
    model[excited] = _DEGREES * np.unwrap(np.angle(r.simulated[excited]))
    model -= 360.0 * np.round(np.nanmean(model) / 360.0)
    away = _DEGREES * np.angle(r.measured * np.conj(r.simulated))  # between -180 and 180
    phase = np.where(np.isfinite(model), model, 0.0) + away
    ratio = np.divide(r.radius, np.abs(r.measured), out=np.ones(len(phase)), where=r.is_compared)
    half = _DEGREES * np.arcsin(np.clip(ratio, 0.0, 1.0))
    shown = r.is_compared
    y = Axis(span([(phase - half)[shown], (phase + half)[shown], model]), "deg", tick_count=3)
    marks = (*_records(r, phase, half), Line(*_model_line(r, model), MODEL))
    return Panel(box, _omega_axis(r, "ω [rad/s]"), y, marks)


def _records(r: FrequencyResponse, values: Array, half: Array) -> list[Mark]:
    """Points with bars at the frequencies that are compared, open where the model leaves the region."""
    marks: list[Mark] = []
    for w, value, h in zip(r.omega[r.is_compared], values[r.is_compared], half[r.is_compared], strict=True):
        marks.append(Line(np.full(2, w), np.array([value - h, value + h]), BAR))
    for chosen, marker in ((r.is_inside, RECORDS), (~r.is_inside, OUTSIDE)):
        rows = r.is_compared & chosen
        if rows.any():
            marks.append(Points(r.omega[rows], values[rows], marker))
    return marks


def _model_line(r: FrequencyResponse, values: Array) -> tuple[Array, Array]:
    rows = np.array(r.excited)
    return r.omega[rows], values[rows]


def _omega_axis(r: FrequencyResponse, name: str) -> Axis:
    low, high = r.excited_range
    return Axis((low / _FREE, high * _FREE), name, is_logarithmic=True, tick_count=4, has_labels=bool(name))


def _display(r: FrequencyResponse) -> tuple[float, str]:
    """Factor from SI and unit of a magnitude: degrees on either side cancel."""
    (over, above), (under, below) = (display_unit(channel_unit(c)) for c in (r.output, r.input))
    if below == "1":
        return over / under, above
    if above.startswith(below):
        rest = above.removeprefix(below).strip("/ ")
        return over / under, f"1/{rest}" if rest else "1"
    return over / under, f"{above} per {below}"
