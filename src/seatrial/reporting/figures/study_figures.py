"""Figures of a study: curves, bars, matrices."""

from seatrial.core.figures.chart import Chart
from seatrial.core.figures.panels import NamedCurve, bars_chart, curves_chart, heat_map
from seatrial.core.results import Bars, Figure, Matrix


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
