"""A record plots its track and every channel."""

import matplotlib
import numpy as np
from matplotlib import pyplot

from seatrial.core.values import Record
from seatrial.core.values.record_chart import has_moving_track, has_track, is_constant, record_chart

matplotlib.use("Agg")
TIME = np.linspace(0.0, 60.0, 200)
RECORD = Record.from_arrays(
    "turn", TIME, {"x0": 9.0 * np.sin(TIME / 9), "y0": 9.0 * np.cos(TIME / 9), "psi": TIME / 9, "u": np.ones(200)}
)


def test_a_panel_for_the_track_and_one_for_each_channel() -> None:
    chart = record_chart(RECORD, 3.0)
    assert chart.title == "turn"
    assert [panel.y.name for panel in chart.panels] == ["x₀, north [m]", "ψ [deg]", "u [m/s]"]
    assert len(record_chart(RECORD.without("x0")).panels) == 2


def test_plot_draws_the_chart() -> None:
    figure = RECORD.plot()
    assert [axes.get_ylabel() for axes in figure.axes] == ["x₀, north [m]", "ψ [deg]", "u [m/s]"]
    pyplot.close(figure)


def test_what_is_known_of_a_record() -> None:
    assert has_track(RECORD) and not has_track(RECORD.without("y0"))
    assert has_moving_track(RECORD)
    still = RECORD
    for name in ("x0", "y0"):
        still = still.with_channel(name, still.channel(name).with_values(0.0 * still[name]))
    assert has_track(still) and not has_moving_track(still)
    assert is_constant(RECORD, "u") and not is_constant(RECORD, "psi")
