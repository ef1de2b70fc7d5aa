"""Matplotlib: each panel becomes axes with its range, ticks, names and marks."""

from collections.abc import Iterator

import numpy as np
import pytest

from seatrial.core.figures.chart import (
    Area,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Marker,
    Panel,
    Points,
    Rectangle,
    Region,
    Rule,
    Shape,
    Stroke,
    Text,
    row_axis,
)
from seatrial.core.figures.matplotlib_axes import matplotlib_figure

STROKE = Stroke("#123456", 1.0, "5 2")
TWO = np.array([1.0, 2.0])


@pytest.fixture(autouse=True)
def close() -> Iterator[None]:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    yield
    pyplot.close("all")


def test_panels_become_axes_at_their_place_with_their_ranges() -> None:
    panel = Panel(
        Region(100.0, 20.0, 200.0, 100.0),
        Axis((0.1, 100.0), "f [Hz]", is_logarithmic=True),
        Axis((0.0, 1.0)),
        (Line(TWO, TWO, STROKE),),
        "gain",
        is_y_down=True,
    )
    chart = Chart(
        "c",
        (panel, panel),
        (LegendEntry("a", STROKE), LegendEntry("b", Marker(Shape.UP, 3.0, "#123456")), LegendEntry("c", "#123456")),
        width=400.0,
    )
    figure = matplotlib_figure(chart)
    first = figure.axes[0]
    assert len(figure.axes) == 2 and tuple(figure.get_size_inches()) == pytest.approx((4.0, chart.height() / 100.0))
    assert first.get_position().x0 == pytest.approx(0.25) and first.get_position().width == pytest.approx(0.5)
    assert first.get_xlim() == pytest.approx((0.1, 100.0)) and first.get_xscale() == "log"
    assert first.get_ylim() == (1.0, 0.0)
    assert first.get_xlabel() == "f [Hz]" and first.get_title(loc="left") == "gain"
    assert [text.get_text() for text in figure.texts] == ["a", "b", "c"]


def test_every_kind_of_mark_is_drawn() -> None:
    marks = (
        Line(TWO, TWO, STROKE), Points(TWO, TWO, Marker(Shape.CROSS, 3.0, "#123456")), Rule(0.5, STROKE),
        Rule(1.5, STROKE, is_vertical=True), Area(np.array([1.0, 2.0, 2.0]), np.array([0.0, 1.0, 0.0]), "#ffffff"),
        Rectangle(1.0, 0.0, 2.0, 1.0, "#ffffff", gap=1.0), Text(1.0, 0.5, "here", dx=3.0),
    )  # fmt: skip
    panel = Panel(Region(50.0, 5.0, 200.0, 100.0), row_axis(("a", "b", "c")), Axis((0.0, 1.0)), marks)
    figure = matplotlib_figure(Chart("c", (panel,)))
    figure.canvas.draw()
    axes = figure.axes[0]
    assert (len(axes.lines), len(axes.patches), len(axes.texts)) == (4, 2, 1)
    assert [label.get_text() for label in axes.get_xticklabels()] == ["a", "b", "c"]


def test_a_panel_without_frame_has_no_axis() -> None:
    panel = Panel(Region(0.0, 0.0, 200.0, 100.0), Axis((0.0, 1.0)), Axis((0.0, 1.0)), has_frame=False)
    assert not matplotlib_figure(Chart("c", (panel,))).axes[0].axison
