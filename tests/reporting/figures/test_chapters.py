"""Records, residuals, roll, profiles, differences, designs and studies have a panel for what they hold."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_tuning import fabricated_fin
from tests.reporting.test_roll_chapter import KNOWN

from seatrial.core.figures.chart import Area, Line, Points, Text
from seatrial.core.results import Bars, Curve, Figure, Fit, Matrix, TrialLimits
from seatrial.reporting.figures.coefficient_charts import profile_chart
from seatrial.reporting.figures.control_charts import difference_chart
from seatrial.reporting.figures.designed_manoeuvre import drift_angle, order_view, track_chart
from seatrial.reporting.figures.record_charts import residual_series, track_overview, whiteness_chart
from seatrial.reporting.figures.response_charts import roll_damping_chart, study_chart


@pytest.fixture(scope="module")
def fit() -> Fit:
    return complete_fit(fabricated_fit())


def test_tracks_are_those_with_positions(fit: Fit) -> None:
    chart = track_overview([fit.records[0].without("x0"), *fit.records[1:]], 5.0)
    assert chart is not None and len(chart.panels) == len(fit.records) - 1
    assert track_overview([fit.records[0].without("x0")], 5.0) is None


def test_residuals_have_a_series_and_two_panels_a_channel(fit: Fit) -> None:
    chart = whiteness_chart(fit.residuals)
    assert chart is not None and len(chart.panels) == 2 * len(fit.residuals)
    assert [panel.title for panel in chart.panels[:2]] == ["u: autocorrelation", "against the normal"]
    assert residual_series(fit.residuals).count('"label"') == len(fit.residuals)
    long = replace(fit.residuals[0], autocorrelation=np.linspace(1.0, 0.0, 200))
    assert whiteness_chart([long]) is not None and whiteness_chart([]) is None and residual_series([]) == ""


def test_every_recorded_swing_is_a_point_in_both_panels() -> None:
    chart = roll_damping_chart(KNOWN)
    assert chart is not None and len(chart.legend) == 2
    for panel in chart.panels:
        assert [len(mark.x) for mark in panel.marks if isinstance(mark, Points)] == [len(KNOWN.swings)]
        assert sum(isinstance(mark, Area) for mark in panel.marks) == 1
    bare = roll_damping_chart(replace(KNOWN, swings=()))
    assert bare is not None and len(bare.legend) == 1
    curves = ("amplitude", "damping", "damping_lower", "damping_upper", "period", "period_lower", "period_upper")
    assert roll_damping_chart(replace(KNOWN, **dict.fromkeys(curves, ()))) is None


def test_profiles_show_the_bounds_they_have(fit: Fit) -> None:
    assert fit.identifiability is not None
    profiles = fit.identifiability.profiles
    chart = profile_chart(profiles, {c.name: c.unit for c in fit.coefficients})
    assert chart is not None
    bounds = [sum(isinstance(m, Line) for m in panel.marks) - 1 for panel in chart.panels]
    assert bounds == [(p.lower is not None) + (p.upper is not None) for p in profiles]
    assert profile_chart([], {}) is None


def test_differences_have_a_row_each() -> None:
    pairs = fabricated_fin().paired_differences
    chart = difference_chart(pairs)
    assert chart is not None and len(chart.panels[0].y.ticks or ()) == len(pairs)
    assert chart.panels[0].x.ends[0] < 0.0 and difference_chart(()) is None


def test_a_design_shows_its_orders_and_limits() -> None:
    design = fabricated_design()
    view = order_view(design)
    assert [panel.label for panel in view.channels] == ["δ [deg]", "drift β [deg]"] and len(view.tracks) == 1
    assert [rule.value for rule in view.channels[0].limits] == pytest.approx([-35.0, 35.0])
    ordered, moved = view.channels[0].curves
    assert (ordered.name, moved.name) == ("ordered", "moved")
    first = design.orders[0]
    assert ordered.values[ordered.time >= first.time][0] == pytest.approx(np.degrees(first.values["delta"]))
    assert order_view(replace(design, limits=TrialLimits())).channels[1].limits == ()


def test_the_drift_angle_is_positive_with_the_bow_to_starboard_of_the_course() -> None:
    record = fabricated_design().designed.executed
    drift = drift_angle(record)
    assert drift is not None and np.all(np.sign(drift) == -np.sign(record["v"]))
    assert drift_angle(record.without("v")) is None


def test_a_sea_room_that_is_far_away_is_named_but_not_drawn() -> None:
    design = fabricated_design()
    near, far = (track_chart(replace(design, limits=replace(design.limits, sea_room=r))) for r in (120.0, 9000.0))
    assert near is not None and far is not None
    texts = [[m.words for m in chart.panels[0].marks if isinstance(m, Text)] for chart in (near, far)]
    assert texts == [["sea room 120 m"], ["sea room 9000 m, beyond the picture"]]
    assert near.panels[0].x.ends[1] > 120.0
    bare = replace(design, designed=replace(design.designed, executed=design.plan))
    assert track_chart(bare) is None


def test_a_study_has_curves_bars_and_matrices() -> None:
    x = np.linspace(0.0, 1.0, 9)
    figures = (
        Figure("f", "x", "y", (Curve("c", x, x),)), Bars("b", ("a",), {"s": (1.0,)}, "1"),
        Matrix("m", ("a",), ("b",), np.ones((1, 1))),
    )  # fmt: skip
    assert [chart.title for chart in map(study_chart, figures) if chart] == ["f", "b", "m"]
