"""SVG: gaps break lines, words are escaped, nothing is drawn outside its panel."""

import re

import numpy as np
import pytest

from seatrial.core.figures.chart import Axis, Chart, LegendEntry, Panel, Region
from seatrial.core.figures.marks import Area, Line, Mark, Marker, Points, Rectangle, Rule, Shape, Stroke, Text
from seatrial.core.figures.svg_text import svg

STROKE = Stroke("#123456", 1.0, "5 2")


def drawn(*marks: Mark) -> str:
    panel = Panel(Region(0.0, 0.0, 100.0, 100.0), Axis((0.0, 4.0)), Axis((0.0, 1.0)), marks, has_frame=False)
    return svg(Chart("c", (panel,), width=100.0))


def test_a_gap_breaks_the_line() -> None:
    text = drawn(Line(np.arange(5.0), np.array([0.0, 1.0, np.nan, 1.0, 0.0]), STROKE))
    assert text.count("M") == 2 and "nan" not in text and 'stroke-dasharray="5 2"' in text


def test_a_line_ends_at_the_edges_of_its_panel() -> None:
    x = np.array([0.0, 4.0])
    inside, outside = (drawn(Line(x, np.array([0.0, top]), STROKE)) for top in (1.0, 9.0))
    assert inside.count("<svg") == 1
    assert outside.count("<svg") == 2 and 'viewBox="0.0 0.0 100.0 100.0"' in outside


def test_points_outside_the_panel_and_without_a_value_are_left_out() -> None:
    x, y = np.array([1.0, 9.0, np.nan, 2.0]), np.array([0.5, 0.5, 0.5, -3.0])
    for shape in Shape:
        assert drawn(Points(x, y, Marker(shape, 3.0, "#000000"))).count("M") == 1
    assert "<path" not in drawn(Points(x[1:], y[1:], Marker(Shape.CIRCLE, 3.0, "#000000")))


def test_a_rectangle_has_its_corners_whatever_their_order() -> None:
    for mark in (Rectangle(1.0, 0.2, 3.0, 0.7, "#fff"), Rectangle(3.0, 0.7, 1.0, 0.2, "#fff")):
        assert '<rect x="25.0" y="30.0" width="50.0" height="50.0" fill="#fff"/>' in drawn(mark)


def test_a_rule_crosses_the_panel() -> None:
    assert 'd="M0.0 50.0L100.0 50.0"' in drawn(Rule(0.5, STROKE))
    assert 'd="M25.0 0.0L25.0 100.0"' in drawn(Rule(1.0, STROKE, is_vertical=True))


def test_an_area_needs_three_points() -> None:
    x = np.array([0.0, 1.0, 2.0])
    assert "<path" in drawn(Area(x, np.array([0.0, 1.0, 0.0]), "#fff"))
    assert "<path" not in drawn(Area(x, np.array([0.0, np.nan, 0.0]), "#fff"))


def test_words_are_escaped_everywhere() -> None:
    hostile = '"><script>'
    panel = Panel(Region(0, 0, 99, 99), Axis((0, 1), hostile), Axis((0, 1), hostile), (Text(0, 0, hostile),), hostile)
    text = svg(Chart(hostile, (panel,), (LegendEntry(hostile, "#ffffff"),)))
    assert "<script>" not in text and text.count("&lt;script&gt;") == 6


@pytest.mark.parametrize("sample", [STROKE, Marker(Shape.UP, 4.0, "#123456"), "#123456"])
def test_a_legend_has_a_sample_before_each_name(sample: Stroke | Marker | str) -> None:
    panel = Panel(Region(0.0, 0.0, 100.0, 100.0), Axis((0.0, 4.0)), Axis((0.0, 1.0)), has_frame=False)
    text = svg(Chart("c", (panel,), (LegendEntry("name", sample),)))
    assert text.count("#123456") == 1 and text.index("#123456") < text.index(">name<")


def test_ticks_stand_at_their_values() -> None:
    panel = Panel(Region(50.0, 10.0, 100.0, 100.0), Axis((0.0, 2.0), tick_count=3), Axis((0.0, 1.0), has_labels=False))
    assert re.findall(r'<text x="([\d.]+)" y="123.0"[^>]*>([^<]*)', svg(Chart("c", (panel,)))) == [
        ("50.0", "0"), ("100.0", "1"), ("150.0", "2"),
    ]  # fmt: skip


def test_no_chart_no_text() -> None:
    assert svg(None) == ""
