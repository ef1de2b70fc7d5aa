"""Errors some samples ahead, over the horizon: held-out and training runs next to the last value held."""

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
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
    tiles,
    whole_decades,
)
from seatrial.core.results.prediction import KStepErrors
from seatrial.core.values import display_unit
from seatrial.core.values.notation import channel_label

COLUMNS, HEIGHT = 3, 130.0  # panels in a row; px, chosen
HELD_OUT, TRAINING = Stroke(ACCENT, 1.8), Stroke(INK, 1.1, "5 3")  # px, chosen
LAST_VALUE = Stroke(GREY, 1.6)  # px, chosen
_MARKER = 2.4  # px, chosen
# share that stays free at the ends of a logarithmic axis of horizons
_FREE = 1.25


def k_step_chart(errors: tuple[KStepErrors, ...]) -> Chart | None:
    """Return a panel for each channel, both axes logarithmic; None without errors."""
    if not errors:
        return None
    channels = list(dict.fromkeys(e.channel for e in errors))
    boxes = tiles(len(channels), COLUMNS, HEIGHT, left=58.0, right=10.0, gap=30.0)  # px, chosen
    panels = [
        _panel(box, [e for e in errors if e.channel == c], is_last=k + COLUMNS >= len(channels))
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
