"""The helmsman's table in people's units."""

import math

import pytest
from tests.reporting.fabricated_design import fabricated_design

from seatrial.core.results import Actuator, TimedOrder
from seatrial.data.folder.gains_file import channel_display_unit, order_cells, order_headings, orders_csv

ACTUATORS = (Actuator("delta", -0.6, 0.6, 0.05, 5.0), Actuator("v_j", 1.0, 3.0, 0.5, 5.0))


def test_angles_are_given_in_degrees() -> None:
    assert channel_display_unit("delta") == (pytest.approx(180.0 / math.pi), "deg")
    assert channel_display_unit("no channel of the notation") == (1.0, "1")
    assert order_headings(ACTUATORS) == ["time [s]", "delta [deg]", "v_j [m/s]"]


def test_an_order_is_as_fine_as_a_hundredth_of_the_range() -> None:
    assert order_cells(TimedOrder(6.25, {"delta": math.radians(10.04), "v_j": 1.23456}), ACTUATORS) == [
        "6.25", "10", "1.23",
    ]  # fmt: skip
    assert order_cells(TimedOrder(7.0, {}), ACTUATORS) == ["7", "", ""]


def test_the_file_has_a_line_for_each_order() -> None:
    design = fabricated_design()
    lines = orders_csv(design).splitlines()
    assert lines[0] == "time [s],delta [deg]" and len(lines) == 1 + len(design.orders)
