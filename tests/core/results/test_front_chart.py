"""Fronts: a panel for each pair of objectives, in degrees, logarithmic where values are far apart."""

import math
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin

from seatrial.core.results.front_chart import degree_unit, front_chart, scaled_axis
from seatrial.core.values import InputError

matplotlib.use("Agg")


def test_a_panel_for_each_pair_of_objectives() -> None:
    three, two = front_chart(fabricated_fin()), front_chart(fabricated_autopilot())
    assert three is not None and len(three.panels) == 3 and two is not None and len(two.panels) == 1
    assert two.panels[0].x.name == "heading variance [deg²]"
    assert [entry.words for entry in two.legend] == ["front, two gains", "chosen", "given"]


def test_one_objective_has_no_front() -> None:
    fin = fabricated_fin()
    single = replace(fin.front, objectives=fin.front.objectives[:, :1])
    assert front_chart(replace(fin, objectives={"roll variance": "rad^2"}, front=single, extended_fronts=())) is None


@pytest.mark.parametrize(
    ("unit", "factor", "shown"),
    [
        ("rad^2", math.degrees(1.0) ** 2, "deg²"),
        ("rad^2/s^2", math.degrees(1.0) ** 2, "deg²/s²"),
        ("rad/s", math.degrees(1.0), "deg/s"),
        ("1/min", 1.0, "1/min"),
        ("1", 1.0, ""),
        ("", 1.0, ""),
    ],
)
def test_objectives_are_in_degrees(unit: str, factor: float, shown: str) -> None:
    assert degree_unit(unit) == (pytest.approx(factor), shown)


def test_an_axis_is_logarithmic_where_values_are_far_apart() -> None:
    wide = scaled_axis([np.array([0.01, 30.0, np.inf])], "x")
    assert wide.is_logarithmic and wide.ends[0] < 0.01 < 30.0 < wide.ends[1]
    assert not scaled_axis([np.array([-0.01, 30.0])], "x").is_logarithmic


def test_plot_draws_the_front_or_the_sensitivities() -> None:
    fin = fabricated_fin()
    assert len(fin.plot().axes) == 3
    assert fabricated_autopilot().plot().axes[0].get_xlabel() == "heading variance [deg²]"
    pyplot.close("all")
    with pytest.raises(InputError, match="neither a front nor"):
        fabricated_bare().plot()
