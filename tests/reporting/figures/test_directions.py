"""Directions lie in their zones; what is not determined has a note."""

import math

from seatrial.core.figures.chart import Points, Shape, Text
from seatrial.core.results import Direction
from seatrial.reporting.figures.coefficient_charts import combination_text, direction_chart


def test_markers_follow_the_zones() -> None:
    spreads = (math.inf, 3.0, 0.4, 0.02)
    chart = direction_chart([Direction({"Y_v": 1.0}, spread, "") for spread in spreads])
    assert chart is not None
    points = [mark for mark in chart.panels[0].marks if isinstance(mark, Points)]
    assert [(p.marker.shape, p.marker.fill != "#ffffff") for p in points] == [
        (Shape.SQUARE, True), (Shape.CIRCLE, False), (Shape.CIRCLE, True),
    ]  # fmt: skip
    assert [float(p.x[0]) for p in points] == [300.0, 40.0, 2.0]
    assert sum(isinstance(m, Text) and m.words.startswith("no information") for m in chart.panels[0].marks) == 1
    assert direction_chart([]) is None


def test_the_parts_of_a_direction_are_its_largest() -> None:
    direction = Direction({"Y_v": 0.74, "N_v": -0.56, "a": 0.3, "b": 0.25, "c": 0.01}, 0.4, "")
    assert combination_text(direction) == "0.74 Y_v − 0.56 N_v + 0.30 a …"
    assert combination_text(Direction({"Y_v": -1.0}, 0.4, "")) == "− Y_v"
