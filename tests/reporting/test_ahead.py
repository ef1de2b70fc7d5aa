"""Chapters on predictions some samples ahead and on frequency responses."""

from dataclasses import replace

from tests.reporting.fabricated import fabricated_fit
from tests.reporting.section_text import cells, header

from seatrial.core.results import Fit
from seatrial.reporting.figures.response_charts import frequency_chart, k_step_chart
from seatrial.reporting.prediction_chapter import frequency_section, k_step_section


def test_errors_stand_by_horizon_with_those_of_the_last_value(fit: Fit) -> None:
    table = k_step_section(fit).table
    assert header(table)[2:] == ("1 (0.2 s)", "3 (0.6 s)", "10 (2 s)", "30 (6 s)")
    held, _, trained, *_ = cells(table)
    assert held[:3] == ("r, deg/s", "held-out runs", "0.0120 (0.0241)")
    assert (held[-1], trained[1], trained[-1]) == ("", "training runs", "0.344 (0.689)")
    chart = k_step_chart(fit.k_step_errors)
    assert chart is not None
    assert len(chart.panels) == 2
    assert [e.words for e in chart.legend] == ["held-out runs", "training runs", "the last value held"]


def test_responses_stand_with_what_was_compared(fit: Fit) -> None:
    rows = cells(frequency_section(fit).table)
    assert [row[0] for row in rows] == ["u over δ", "v over δ", "r over δ"]
    (yaw,) = [r for r in fit.frequency_responses if r.output == "r"]
    assert rows[2][2] == str(int(yaw.is_compared.sum()))
    chart = frequency_chart([yaw])
    assert chart is not None
    assert [p.title for p in chart.panels] == ["r over δ", ""]
    assert [p.y.name for p in chart.panels] == ["1/s", "deg"]


def test_a_fit_without_them_has_no_chapters() -> None:
    bare = fabricated_fit()
    assert not k_step_section(bare) and not frequency_section(bare)
    assert k_step_chart(()) is None
    assert frequency_chart(()) is None
    weak = [replace(r, radius=r.radius + abs(r.measured)) for r in bare.frequency_responses]
    assert frequency_chart(weak) is None
