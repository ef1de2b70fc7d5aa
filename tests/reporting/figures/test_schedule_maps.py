"""Maps show the cost of every condition, of the schedule and of the gains it is compared with."""

import math
from dataclasses import replace

import pytest
from tests.reporting.fabricated_tuning import fabricated_fin

from seatrial.core.figures.chart import Line, Panel, Rectangle, Text
from seatrial.core.results.tuning import OperatingPoint
from seatrial.reporting.figures.control_charts import schedule_chart


@pytest.fixture(scope="module")
def schedule() -> tuple[OperatingPoint, ...]:
    return fabricated_fin().schedule


def maps(schedule: tuple[OperatingPoint, ...]) -> list[Panel]:
    chart = schedule_chart(schedule)
    assert chart is not None
    return list(chart.panels[:-1])  # the last is the key


def texts(panels: list[Panel]) -> list[str]:
    return [mark.words for panel in panels for mark in panel.marks if isinstance(mark, Text)]


def test_every_condition_has_a_cell_with_its_cost(schedule: tuple[OperatingPoint, ...]) -> None:
    panels = maps(schedule)
    cells = [mark for panel in panels for mark in panel.marks if isinstance(mark, Rectangle)]
    costs = [f"{cost:.2f}" for point in schedule for cost in (point.cost, *point.baseline_costs.values())]
    assert len(cells) == 3 * len(schedule)
    assert sorted(text for text in texts(panels) if not text.endswith(" m")) == sorted(costs)


def test_conditions_without_feasible_gains_are_underlined(schedule: tuple[OperatingPoint, ...]) -> None:
    underlined = [mark for panel in maps(schedule) for mark in panel.marks if isinstance(mark, Line)]
    assert len(underlined) == sum(not point.is_feasible for point in schedule) > 0


def test_an_unstable_condition_is_named(schedule: tuple[OperatingPoint, ...]) -> None:
    unstable = replace(schedule[0], baseline_costs={"given": math.inf, "chosen everywhere": 0.3})
    assert texts(maps((unstable, *schedule[1:]))).count("unst.") == 1
    assert schedule_chart(()) is None
