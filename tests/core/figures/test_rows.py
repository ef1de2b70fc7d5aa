"""Rows have room for their names, and an axis of whole decades."""

import pytest

from seatrial.core.figures.rows import decades_axis, no_information, row_panel


def test_long_names_take_room_but_not_the_page() -> None:
    axis = decades_axis([3.0], (1.0, 10.0), "error", " %")
    short, long = (row_panel([name], axis, []) for name in ("Y_v", "a name " * 40))
    assert short.box.left < 50.0 < long.box.left < 0.5 * 864.0
    assert short.is_y_down and short.y.ends == (-0.5, 0.5)


def test_an_axis_has_a_tick_at_every_decade() -> None:
    axis = decades_axis([0.03, 700.0], (1.0, 10.0), "error", " %")
    assert axis.ends == pytest.approx((0.01, 1000.0))
    assert [tick.text for tick in axis.ticks or ()] == ["0.01 %", "0.1 %", "1 %", "10 %", "100 %", "1\u202f000 %"]
    assert no_information(axis, 2).x == axis.ends[1]
