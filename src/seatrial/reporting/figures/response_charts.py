"""Charts over frequency, amplitude and horizon: responses, damping, errors ahead, and those of a study."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
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
    tiles,
    whole_decades,
)
from seatrial.core.figures.panels import NamedCurve, bars_chart, curves_chart, heat_map
from seatrial.core.figures.run import band
from seatrial.core.results import Bars, Figure, Matrix, RollCharacteristics
from seatrial.core.results.prediction import KStepErrors
from seatrial.core.results.ship_motions import FrequencyResponse
from seatrial.core.values import display_unit
from seatrial.core.values.notation import channel_label, channel_letter, channel_unit

# Frequency responses: magnitude and phase of the records with their 95 % region, and of the model.

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


# Errors some samples ahead, over the horizon: held-out and training runs next to the last value held.

AHEAD_COLUMNS, HEIGHT = 3, 130.0  # panels in a row; px, chosen
HELD_OUT, TRAINING = Stroke(ACCENT, 1.8), Stroke(INK, 1.1, "5 3")  # px, chosen
LAST_VALUE = Stroke(GREY, 1.6)  # px, chosen
_MARKER = 2.4  # px, chosen


def k_step_chart(errors: tuple[KStepErrors, ...]) -> Chart | None:
    """Return a panel for each channel, both axes logarithmic; None without errors."""
    if not errors:
        return None
    channels = list(dict.fromkeys(e.channel for e in errors))
    boxes = tiles(len(channels), AHEAD_COLUMNS, HEIGHT, left=58.0, right=10.0, gap=30.0)  # px, chosen
    panels = [
        _panel(box, [e for e in errors if e.channel == c], is_last=k + AHEAD_COLUMNS >= len(channels))
        for k, (c, box) in enumerate(zip(channels, boxes, strict=True))
    ]
    roles = {e.role for e in errors}
    legend = [LegendEntry("held-out runs", HELD_OUT)] if "validation" in roles else []
    legend += [LegendEntry("training runs", TRAINING)] if "training" in roles else []
    legend.append(LegendEntry("the last value held", LAST_VALUE))
    return Chart("errors some samples ahead, over the horizon", tuple(panels), tuple(legend))


def _panel(box: Region, errors: list[KStepErrors], *, is_last: bool) -> Panel:
    factor = display_unit(errors[0].unit)[0]
    marks: list[Mark] = []
    values: list[float] = []
    for e in sorted(errors, key=lambda e: e.role):
        x = np.array(e.seconds)
        stroke = HELD_OUT if e.role == "validation" else TRAINING
        held, rms = (factor * np.array(column) for column in (e.held_rms, e.rms))
        marks += [*_curve(x, held, LAST_VALUE), *_curve(x, rms, stroke)]
        values += [v for v in (*held.tolist(), *rms.tolist()) if v > 0.0]
    horizons = [s for e in errors for s in e.seconds]
    middle = float(np.median(values))
    x_axis = Axis((min(horizons) / _FREE, max(horizons) * _FREE), "s ahead" if is_last else "", is_logarithmic=True,
                  tick_count=4)  # fmt: skip
    y_axis = Axis(whole_decades(values, (middle, middle)), channel_label(errors[0].channel, errors[0].unit),
                  is_logarithmic=True, tick_count=4)  # fmt: skip
    return Panel(box, x_axis, y_axis, tuple(marks), title="")


def _curve(x: Array, y: Array, stroke: Stroke) -> list[Mark]:
    return [Line(x, y, stroke), Points(x, y, Marker(Shape.CIRCLE, _MARKER, stroke.colour, stroke.colour))]


# Damping and period of roll over the amplitude of a swing: the model with its band, each recorded swing as a dot.

# how far the axis follows the band, in spans of model and swings
REACH = 1.5
_MODEL, _SWING = Stroke(INK, 1.5), Marker(Shape.CIRCLE, 1.8, "none", "#1b4f72b3", 0.0)  # px, chosen


def roll_damping_chart(roll: RollCharacteristics) -> Chart | None:
    """Return damping and period side by side; None where no amplitude is known."""
    if not roll.amplitude:
        return None
    swings = np.array(roll.swings).reshape(-1, 3)
    left, right = tiles(2, 2, 250.0, left=58.0, right=12.0, top=8.0)  # px, chosen
    panels = (
        _damping_panel(roll, swings[:, [0, 1]], (roll.damping, roll.damping_lower, roll.damping_upper), left,
               "equivalent damping b_e, 1/s"),
        _damping_panel(roll, swings[:, [0, 2]], (roll.period, roll.period_lower, roll.period_upper), right,
               "period of a swing, s"),
    )  # fmt: skip
    legend = [LegendEntry("model with 95 % band", _MODEL)]
    legend += [LegendEntry("one recorded swing", _SWING)] if len(swings) else []
    return Chart("Damping and period of roll", panels, tuple(legend))


def _damping_panel(
    roll: RollCharacteristics, swings: Array, curves: tuple[tuple[float, ...], ...], box: Region, name: str
) -> Panel:
    amplitude = np.degrees(np.array(roll.amplitude))
    middle, low, high = (np.array(curve) for curve in curves)
    reach = REACH * max(float(np.ptp(np.concatenate([middle, swings[:, 1]]))), 1e-6)  # px, chosen
    visible = [middle, swings[:, 1], np.maximum(low, middle.min() - reach), np.minimum(high, middle.max() + reach)]
    marks = (band(amplitude, low, high), Points(np.degrees(swings[:, 0]), swings[:, 1], _SWING),
             Line(amplitude, middle, _MODEL))  # fmt: skip
    x = Axis((0.0, float(amplitude[-1]) * 1.03), "amplitude of the swing, deg")
    return Panel(box, x, Axis(span(visible), name, tick_count=4), marks)


# Figures of a study: curves, bars, matrices.


def study_chart(figure: Figure | Bars | Matrix) -> Chart | None:
    """Return the chart of a figure; None without values."""
    match figure:
        case Bars():
            return bars_chart(
                figure.title, figure.labels, figure.series, figure.unit, is_logarithmic=figure.is_logarithmic
            )
        case Matrix():
            return heat_map(figure.title, figure.rows, figure.columns, figure.values, figure.limit)
        case Figure():
            curves = [NamedCurve(c.name, c.x, c.y) for c in figure.curves]
            return curves_chart(figure.title, curves, figure.x_label, figure.y_label, is_map=figure.is_map)
