"""Charts as SVG text: paths, marks, and colours for a dark screen."""

import colorsys
import re

import numpy as np
import pytest

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    Area,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Panel,
    Points,
    Rectangle,
    Region,
    Rule,
    Shape,
    Stroke,
    Text,
)
from seatrial.core.figures.svg_text import UNSEEN, night_colour, night_rules, path_data, svg, visible_points

# SVG: gaps break lines, words are escaped, nothing is drawn outside its panel.

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


# Paths are short and no point of a line is farther from what is drawn than a reader can see.


def positions(data: str) -> Array:
    """The corners of a path of one stretch."""
    start, _, moves = data.partition("l")
    numbers = [float(n) for n in re.findall(r"-?\d*\.?\d+", moves)]
    first = [float(n) for n in re.findall(r"-?\d*\.?\d+", start)]
    return np.cumsum(np.array([first, *np.reshape(numbers, (-1, 2)).tolist()]), axis=0)


def distance_to_line(corners: Array, x: float, y: float) -> float:
    """From a point to the nearest part of a line."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    share = np.clip(((x - a[:, 0]) * d[:, 0] + (y - a[:, 1]) * d[:, 1]) / (d**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(a[:, 0] + share * d[:, 0] - x, a[:, 1] + share * d[:, 1] - y).min())


def test_no_point_is_farther_from_the_line_than_can_be_seen() -> None:
    t = np.linspace(0.0, 20.0, 400)
    px, py = 40.0 * t, 200.0 + 80.0 * np.sin(t)
    data = path_data(px, py)
    corners = positions(data)
    # what is left out, and rounding to tenths of both ends of a part
    assert max(distance_to_line(corners, x, y) for x, y in zip(px, py, strict=True)) < UNSEEN + 0.1
    assert len(corners) < 150 and len(data) < 1200


def test_a_straight_line_is_two_points_and_noise_stays() -> None:
    t = np.linspace(0.0, 100.0, 50)
    assert visible_points(t, 2.0 * t).sum() == 2
    assert visible_points(t, np.where(np.arange(50) % 2, 1.0, -1.0)).all()
    assert visible_points(np.array([0.0, 50.0, 0.0]), np.zeros(3)).all()


def test_numbers_are_short_and_gaps_stay_gaps() -> None:
    x = np.array([1.0, 2.5, 2.0, np.nan, 7.0, 7.0])
    assert path_data(x, np.array([0.0, -0.5, 3.0, 1.0, 4.0, 9.25])) == "M1 0l1.5-.5-.5 3.5M7 4l0 5.2"
    assert path_data(np.array([np.nan]), np.array([1.0])) == ""


# Colours on a dark screen keep their hue and stand out from the ground as much as on a light one.

GROUND = "#14191c"  # --ground of core/pages/templates/dark.css


def luminance(colour: str) -> float:
    """Relative luminance (W3C, Web Content Accessibility Guidelines 2.1, definition)."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Contrast ratio (same source)."""
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colour", [ACCENT, INK, SECOND])
def test_lines_and_letters_are_read_on_either_ground(colour: str) -> None:
    assert contrast(colour, "#ffffff") > 4.5 and contrast(night_colour(colour), GROUND) > 4.5


def test_curves_differ_from_the_broad_grey_line_below_them() -> None:
    for pair in ((ACCENT, GREY), (night_colour(ACCENT), night_colour(GREY))):
        assert contrast(*pair) > 2.0


def test_hue_and_transparency_stay() -> None:
    hue = [colorsys.rgb_to_hls(*(int(c[k : k + 2], 16) / 255 for k in (1, 3, 5)))[0] for c in
           (ACCENT, night_colour(ACCENT))]  # fmt: skip
    assert hue[0] == pytest.approx(hue[1], abs=0.02)
    assert night_colour("#1b4f7230").endswith("30") and len(night_colour("#1b4f7230")) == 9
    assert luminance(night_colour("#ffffff")) < 0.02 < 0.7 < luminance(night_colour("#000000"))


def test_a_rule_is_written_once_for_a_colour() -> None:
    rules = night_rules(["#1b4f72", "#1b4f72"])
    assert rules.count("[fill='#1b4f72']") == rules.count("[stroke='#1b4f72']") == 1


# linear RGB as seen without red-sensitive and without green-sensitive cones (Machado, Oliveira & Fernandes 2009,
# IEEE Trans. Vis. Comput. Graph. 15, 1291-1298, severity 1.0)
PROTANOPIA = ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998))
DEUTERANOPIA = ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881))
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])  # IEC 61966-2-1
WHITE = TO_XYZ.sum(axis=1)


def lab_as_seen(colour: str, sight: tuple[tuple[float, ...], ...]) -> Array:
    """CIELAB (ISO/CIE 11664-4) of a colour as such a reader sees it."""
    parts = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    x = TO_XYZ @ np.clip(np.array(sight) @ linear, 0.0, 1.0) / WHITE
    f = np.where(x > (6 / 29) ** 3, np.cbrt(x), x / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("sight", [PROTANOPIA, DEUTERANOPIA])
def test_lines_differ_for_readers_who_see_no_red_or_no_green(sight: tuple[tuple[float, ...], ...]) -> None:
    """Ten units of CIELAB are ten times what is just seen (CIE 1976)."""
    for colours in ((ACCENT, GREY, SECOND, INK), tuple(map(night_colour, (ACCENT, GREY, SECOND, INK)))):
        seen = [lab_as_seen(colour, sight) for colour in colours]
        for k, one in enumerate(seen):
            assert all(np.linalg.norm(one - other) > 10.0 for other in seen[:k])
