"""Errors as dots: every value has one, those beyond the axis a note."""

import math

from seatrial.core.figures.chart import Points, Text
from seatrial.reporting.figures.coefficient_charts import (
    FILLED,
    OPEN,
    CoefficientError,
    ErrorSeries,
    error_chart,
    estimator_chart,
)


def test_every_known_error_has_a_dot() -> None:
    series = [ErrorSeries("one", [[1.0], [math.inf]], FILLED), ErrorSeries("many", [[2.0, 3.0], [math.nan]], OPEN)]
    chart = error_chart(("a", "b"), series, "error")
    assert chart is not None and [entry.words for entry in chart.legend] == ["one", "many"]
    assert sorted(x for m in chart.panels[0].marks if isinstance(m, Points) for x in m.x) == [1.0, 2.0, 3.0]
    assert sum(isinstance(mark, Text) for mark in chart.panels[0].marks) == 1
    assert error_chart(("a",), [ErrorSeries("one", [[math.nan]], FILLED)], "error") is None


def test_an_estimator_s_largest_error_is_named_and_small_ones_stand_at_the_edge() -> None:
    rows = {
        "one": {"a": CoefficientError(0.0, is_near=True), "b": CoefficientError(1e9, is_near=False)},
        "two": {"a": CoefficientError(3.0, is_near=True)},
    }
    chart = estimator_chart(rows, "error, per cent")
    assert chart is not None
    panel = chart.panels[0]
    assert [mark.words for mark in panel.marks if isinstance(mark, Text)] == ["b", "a"]
    assert min(x for m in panel.marks if isinstance(m, Points) for x in m.x) == 0.1 == round(panel.x.ends[0], 9)
    assert estimator_chart({}, "") is None
