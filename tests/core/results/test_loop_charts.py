"""Margins: the peak allowed is drawn where there is one, and nothing where no loop is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated_tuning import fabricated_bare, fabricated_fin

from seatrial.core.figures.chart import Line, Text
from seatrial.core.results.loop_charts import bode_chart, nyquist_chart, sensitivity_chart, styled_controllers


def test_the_peak_allowed_is_drawn_where_there_is_one() -> None:
    fin = fabricated_fin()
    free = replace(fin, constraints=replace(fin.constraints, Ms=math.inf))
    for draw in (sensitivity_chart, nyquist_chart):
        limited, unlimited = draw(fin), draw(free)
        assert limited is not None and unlimited is not None
        texts = [[m.words for m in chart.panels[0].marks if isinstance(m, Text)] for chart in (limited, unlimited)]
        assert any("Ms = 2" in words for words in texts[0]) and not any("Ms" in words for words in texts[1])


def test_sensitivity_and_complementary_sensitivity_belong_together() -> None:
    """T = L S, so that |T| = |L| |S| at every frequency."""
    fin = fabricated_fin()
    chart = sensitivity_chart(fin)
    assert chart is not None
    s, t = ([mark.y for mark in panel.marks if isinstance(mark, Line)][-1] for panel in chart.panels)
    assert t == pytest.approx(np.abs(fin.chosen.open_loop) * s)


def test_without_a_loop_there_is_no_chart() -> None:
    bare = fabricated_bare()
    assert styled_controllers(bare) == []
    assert all(draw(bare) is None for draw in (sensitivity_chart, nyquist_chart, bode_chart))
    assert len({stroke for _, stroke in styled_controllers(fabricated_fin())}) == len(
        styled_controllers(fabricated_fin())
    )
