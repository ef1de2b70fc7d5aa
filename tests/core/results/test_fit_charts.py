"""A fit plots its coefficients, and its runs measured and simulated."""

from dataclasses import replace

import matplotlib
import pytest
from matplotlib import pyplot
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.figures.chart import Area, Points
from seatrial.core.results import Fit
from seatrial.core.results.fit_charts import (
    coefficients_chart,
    has_band,
    headline_view,
    prediction_chart,
    prediction_view,
)
from seatrial.core.values import InputError, RecordKind

matplotlib.use("Agg")


@pytest.fixture(scope="module")
def fit() -> Fit:
    return complete_fit(fabricated_fit())


def test_a_row_for_each_free_coefficient(fit: Fit) -> None:
    chart = coefficients_chart(fit.coefficients)
    free = [c for c in fit.coefficients if not c.fixed]
    assert chart is not None and [tick.text for tick in chart.panels[0].y.ticks or ()] == [c.name for c in free]
    assert [entry.words for entry in chart.legend] == ["estimate, 95 % interval", "prior, 95 %", "known value"]
    points = [mark for mark in chart.panels[0].marks if isinstance(mark, Points)]
    assert len(points) == len(free) + sum(c.truth is not None for c in free)


def test_without_truth_and_prior_the_legend_says_nothing_of_them(fit: Fit) -> None:
    plain = [replace(c, truth=None, prior_mean=None) for c in fit.coefficients]
    chart = coefficients_chart(plain)
    assert chart is not None and len(chart.legend) == 1
    assert coefficients_chart([c for c in plain if c.fixed]) is None


def test_a_record_that_is_simulated_itself_is_called_a_reference(fit: Fit) -> None:
    p = fit.predictions[0]
    assert [entry.words for entry in prediction_chart(p, 5.0, ()).legend][:2] == ["measured", "simulated, open loop"]
    simulated = replace(p, measured=replace(p.measured, kind=RecordKind.SIMULATED))
    words = [entry.words for entry in prediction_chart(simulated, 5.0, ()).legend]
    assert words[:2] == ["reference (simulated)", "model, open loop"]
    assert simulated.is_reference_simulated and (simulated.reference_word, simulated.model_word) == (
        "reference",
        "model",
    )


def test_inputs_are_shown_as_measured_only(fit: Fit) -> None:
    p = fit.predictions[0]
    chart = prediction_chart(p, 5.0, fit.model.input_names)
    labels = {panel.y.name: sum(type(mark).__name__ == "Line" for mark in panel.marks) for panel in chart.panels}
    assert labels["δ [deg], input"] == 1 and labels["ψ [deg]"] == 2
    assert has_band(p) and any(isinstance(mark, Area) for panel in chart.panels[1:] for mark in panel.marks)
    bare = replace(p, half_width={})
    assert not has_band(bare) and len(prediction_chart(bare, 5.0, ()).legend) == len(chart.legend) - 1


def test_the_only_channel_of_a_run_has_its_error_below(fit: Fit) -> None:
    p = fit.predictions[0]
    only = [name for name in p.measured.channels if name != "r"]
    alone = replace(p, measured=p.measured.without(*only), half_width={})
    assert [panel.y.name for panel in prediction_chart(alone, 5.0, ()).panels] == ["r [deg/s]", "error of r [deg/s]"]


def test_plot_draws_coefficients_or_a_run(fit: Fit) -> None:
    assert len(fit.plot().axes) == 1
    assert len(fit.plot(fit.predictions[0].record).axes) > 3
    pyplot.close("all")


def test_a_run_that_is_unknown_is_refused_with_its_neighbour(fit: Fit) -> None:
    with pytest.raises(InputError, match="zigzag_10_10"):
        fit.plot("zigzag_10_1")
    with pytest.raises(InputError, match="no free coefficient"):
        replace(fit, coefficients=()).plot()


def test_the_headline_of_a_run_is_its_heading_or_what_it_has(fit: Fit) -> None:
    p = fit.predictions[0]
    view = headline_view(p, 5.0, fit.model.input_names)
    assert [c.label for c in view.channels] == ["ψ [deg]", "error of ψ [deg]"] and view.tracks
    names = [curve.name for curve in view.channels[0].curves]
    assert names == ["measured", "simulated"]
    alone = replace(p, measured=p.measured.without("psi"), half_width={})
    assert [c.label for c in headline_view(alone, 5.0, ()).channels] == ["u [m/s]", "error of u [m/s]"]
    assert len(prediction_view(alone, 5.0, ()).channels) > 1
