"""Measures have names, units and as many decimals as their interval shows."""

import pytest

from seatrial.core.results import Measure
from seatrial.reporting.measures import (
    interval_verdict,
    manoeuvre_name,
    measure_decimals,
    measure_label,
    simulated_measure_label,
)


def test_names_and_units() -> None:
    assert measure_label("overshoot_2_deg") == ("2nd overshoot", "deg")
    assert measure_label("advance_L") == ("advance over ground", "L")
    assert simulated_measure_label("advance_L") == ("advance in still water", "L")
    assert simulated_measure_label("period_s") == measure_label("period_s")
    assert measure_label("new_thing_L") == ("new thing", "L") and measure_label("another") == ("another", "")


def test_a_value_outside_is_seen_to_be_outside() -> None:
    """14.08 against [14.09, 14.38]: with one decimal it would read 14.1 in [14.1, 14.4]."""
    assert measure_decimals("deg", Measure(14.08, 14.23, 14.09, 14.38)) == 2
    assert measure_decimals("deg", Measure(12.9, 11.5, 9.9, 13.2)) == 1
    assert measure_decimals("deg", Measure(35.0, 35.0, 35.0, 35.0)) == 1
    assert measure_decimals("L", Measure(3.1, 3.05)) == 2


def test_a_value_is_inside_outside_or_neither() -> None:
    assert interval_verdict("advance_L", Measure(3.0, 3.1, 2.9, 3.2)) == "inside"
    assert interval_verdict("advance_L", Measure(9.0, 3.1, 2.9, 3.2)) == "outside"
    assert interval_verdict("advance_L", Measure(3.0, 3.1)) == ""
    assert interval_verdict("advance_L", Measure(3.0, 3.1, 2.9, 3.2, is_determined=False)) == ""


@pytest.mark.parametrize(("name", "measure", "verdict"), [
    ("initial_turning_time_s", Measure(46.0, 75.0, 20.0, 131.0), "too wide to test"),
    ("initial_turning_time_s", Measure(46.0, 50.0, 30.0, 70.0), "inside"),
    ("initial_turning_time_s", Measure(146.0, 75.0, 20.0, 131.0), "outside"),
    ("speed_loss", Measure(-0.2, -0.3, -1.476, 0.817), "too wide to test"),
    ("speed_loss", Measure(0.3, 0.35, 0.1, 0.6), "inside"),
    ("overshoot_1_deg", Measure(2.0, 3.0, -1.0, 7.0), "inside"),
    ("overshoot_1_deg", Measure(2.0, 3.0, -9.0, 15.0), "too wide to test"),
    ("tactical_diameter_L", Measure(8.7, 9.2, 6.4, 12.1), "inside"),
    ("tactical_diameter_L", Measure(3.0, 3.5, 1.0, 6.0), "too wide to test"),
])  # fmt: skip
def test_an_interval_that_holds_whatever_a_ship_may_do_is_no_test(name: str, measure: Measure, verdict: str) -> None:
    assert interval_verdict(name, measure) == verdict


@pytest.mark.parametrize(("text", "name"), [
    ("zigzag:20/10", "zigzag 20°/10°"),
    ("zigzag:20/10:port", "zigzag 20°/10°, first to port"),
    ("turning-circle:35", "turning circle with 35° to starboard"),
    ("turning-circle:35:starboard", "turning circle with 35° to starboard"),
    ("consecutive-zigzags:2", "consecutive zigzags, 2 executes each"),
    ("prbs:85%:13.3 s:0", "random steps (PRBS), 85 % of the range, 13.3 s at least, seed 0"),
    ("designed", "designed"),
    ("pull-out:20:port", "pull-out from 20° to port"),
    ("pull-out:20", "pull-out from 20° to starboard"),
])  # fmt: skip
def test_manoeuvres_have_the_names_people_use(text: str, name: str) -> None:
    assert manoeuvre_name(text) == name
