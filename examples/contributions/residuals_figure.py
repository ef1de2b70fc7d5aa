"""A figure to copy: residuals over time with the band in which 95 % of them should lie."""

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    SECOND,
    WIDTH,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Panel,
    Region,
    Rule,
    Stroke,
)
from seatrial.core.values import Array

PANEL = Region(64.0, 20.0, WIDTH - 84.0, 220.0)  # [px] leaves room for the numbers of both axes; chosen by eye
TWO_SIDED = 1.96  # [-] quantile of the normal distribution that 95 % lie within on both sides
RESIDUAL, LIMIT = Stroke(ACCENT, 1.2), Stroke(SECOND, 1.0, "4 3")  # [px] widths, and the dashes of the limit


def residual_chart(time: Array, residuals: Array, deviation: float, label: str) -> Chart:
    """Return the chart of residuals (n,) over time [s] (n,), both limits at 1.96 times their standard deviation.

    Args:
        deviation: standard deviation that the estimator assumed, in the unit of the residuals.
        label: of the vertical axis, with the unit, such as "r [deg/s]".
    """
    limit = TWO_SIDED * deviation
    reach = 1.05 * max(limit, float(np.nanmax(np.abs(residuals))))  # 5 % of air above the largest
    marks = (Line(time, residuals, RESIDUAL), Rule(limit, LIMIT), Rule(-limit, LIMIT))
    x = Axis((float(time[0]), float(time[-1])), "t [s]")
    panel = Panel(PANEL, x, Axis((-reach, reach), label), marks)
    legend = (LegendEntry("residual", RESIDUAL), LegendEntry("95 % if the model is right", LIMIT))
    return Chart("residuals over time", (panel,), legend)
