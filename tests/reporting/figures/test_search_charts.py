"""Charts of a search: restarts in order, distances from the package's own estimate, coefficients over iterations."""

import numpy as np
import pytest
from tests.reporting.published_fit import published

from seatrial.core.figures.chart import Points
from seatrial.core.results import Fit, SearchTrack
from seatrial.reporting.figures.search_charts import (
    restart_chart,
    trace_charts,
    track_charts,
    value_charts,
    waterfall_chart,
)


def test_restarts_stand_in_order_with_the_own_estimate_last(fit: Fit) -> None:
    found = published(fit)
    assert found.search is not None
    assert found.reference is not None
    chart = waterfall_chart(found.search, found.reference)
    assert chart is not None
    ticks = chart.panels[0].x.ticks
    assert ticks is not None
    assert [tick.text for tick in ticks] == ["restart 1", "restart 2", "seatrial"]


def test_restarts_are_drawn_by_their_distance_from_the_own_estimate(fit: Fit) -> None:
    found = published(fit)
    assert found.search is not None
    assert found.reference is not None
    chart = restart_chart(found.search, found.reference)
    assert chart is not None
    dots = [mark for mark in chart.panels[0].marks if isinstance(mark, Points) and len(mark.x) == 2]
    positive = found.reference.coefficients[0].estimate > 0
    assert dots[0].x == pytest.approx([-10.0, 2.0] if positive else [10.0, -2.0])


def test_coefficients_over_iterations_come_in_small_groups(fit: Fit) -> None:
    found = published(fit, "sample")
    assert found.search is not None
    assert found.reference is not None
    charts = trace_charts(found.search, found.reference)
    free = sum(not c.fixed for c in fit.coefficients)
    assert len(charts) == int(np.ceil(free / 4))
    assert charts[0].legend


def test_a_followed_stream_shows_motion_and_coefficients_over_time(fit: Fit) -> None:
    found = published(fit, "sample")
    assert found.search is not None
    assert found.reference is not None
    time = np.arange(5.0)
    name = next(iter(found.search.trace))
    track = SearchTrack(
        time,
        {"theta": 0.1 * time},
        {"theta": 0.2 * time},
        {"theta": 0.1 * time},
        {name: 2e7 * time},
        {name: 1e7 * time},
    )
    (motion,) = track_charts(track, "iwho")
    assert [entry.words for entry in motion.legend] == ["recorded", "iwho", "seatrial"]
    assert motion.panels[0].y.name == "theta, deg"
    (values,) = value_charts(track, found.reference, "iwho")
    assert values.panels[0].y.ends[1] == pytest.approx(80.0, rel=0.2)
