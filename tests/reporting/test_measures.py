"""Measures have names, units and as many decimals as their interval shows."""

from seatrial.core.results import Measure
from seatrial.reporting.measures import is_inside, measure_decimals, measure_label


def test_names_and_units() -> None:
    assert measure_label("overshoot_2_deg") == ("2nd overshoot", "deg")
    assert measure_label("advance_L") == ("advance", "L")
    assert measure_label("new_thing_L") == ("new thing", "L") and measure_label("another") == ("another", "")


def test_a_value_outside_is_seen_to_be_outside() -> None:
    """14.08 against [14.09, 14.38]: with one decimal it would read 14.1 in [14.1, 14.4]."""
    assert measure_decimals("deg", Measure(14.08, 14.23, 14.09, 14.38)) == 2
    assert measure_decimals("deg", Measure(12.9, 11.5, 9.9, 13.2)) == 1
    assert measure_decimals("deg", Measure(35.0, 35.0, 35.0, 35.0)) == 1
    assert measure_decimals("L", Measure(3.1, 3.05)) == 2


def test_a_value_is_inside_outside_or_neither() -> None:
    assert is_inside(Measure(3.0, 3.1, 2.9, 3.2)) is True and is_inside(Measure(9.0, 3.1, 2.9, 3.2)) is False
    assert is_inside(Measure(3.0, 3.1)) is None
