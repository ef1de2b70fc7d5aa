"""Damping and period of roll over the amplitude of a swing: the model with its band, each recorded swing as a dot."""

import numpy as np

from seatrial.core.figures.chart import (
    INK,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Marker,
    Panel,
    Points,
    Region,
    Shape,
    Stroke,
    span,
    tiles,
)
from seatrial.core.figures.run import band
from seatrial.core.results import RollCharacteristics

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
        _panel(roll, swings[:, [0, 1]], (roll.damping, roll.damping_lower, roll.damping_upper), left,
               "equivalent damping b_e, 1/s"),
        _panel(roll, swings[:, [0, 2]], (roll.period, roll.period_lower, roll.period_upper), right,
               "period of a swing, s"),
    )  # fmt: skip
    legend = [LegendEntry("model with 95 % band", _MODEL)]
    legend += [LegendEntry("one recorded swing", _SWING)] if len(swings) else []
    return Chart("Damping and period of roll", panels, tuple(legend))


def _panel(
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
