"""Curves have styles that differ without colour; maps have equal scales."""

import numpy as np
import pytest

from seatrial.core.figures.curves import NamedCurve, curves_chart

X = np.linspace(0.0, 10.0, 5000)


def test_curves_have_a_style_each_and_few_points() -> None:
    chart = curves_chart("c", [NamedCurve("a", X, np.sin(X)), NamedCurve("b", X, np.cos(X))], "t [s]", "ψ [deg]")
    lines = chart.panels[0].marks
    assert len({line.stroke.dash for line in lines}) == 2 and all(len(line.x) <= 400 for line in lines)  # type: ignore[union-attr]
    assert [entry.words for entry in chart.legend] == ["a", "b"]


def test_a_map_has_equal_scales() -> None:
    panel = curves_chart("c", [NamedCurve("a", X, 3.0 * X)], "x", "y", is_map=True).panels[0]
    x, y = (np.diff(axis.ends)[0] for axis in (panel.x, panel.y))
    assert x / panel.box.width == pytest.approx(y / panel.box.height)
