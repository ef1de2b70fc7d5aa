"""Measures and extrapolation in words: names, units, and as many decimals as an interval shows."""

import math

import pytest

from seatrial.core.results import Extrapolation, Measure
from seatrial.reporting.measures import (
    extrapolation_text,
    extrapolation_zone,
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


@pytest.mark.parametrize(("index", "where"), [(0.7, "inside"), (1.04, "inside"), (1.15, "edge"), (1.9, "beyond"),
                                              (math.inf, "beyond"), (math.nan, "")])  # fmt: skip
def test_an_extrapolation_is_inside_at_the_edge_or_beyond(index: float, where: str) -> None:
    assert extrapolation_zone(index) == where


def test_an_extrapolation_in_words() -> None:
    ratios = {"yaw_rate": 1.9, "drift": 1.3, "rudder": 0.9}
    assert extrapolation_text(Extrapolation(1.9, ratios)) == (
        "1.9: the run turns 1.9 times as fast as any training run, with 1.3 times the modelled drift angle. "
        "Read its intervals as lower limits."
    )
    assert extrapolation_text(Extrapolation(math.inf, {"drift": math.inf})).startswith(
        "∞: the run drifts, as the model has it, at ∞ times"
    )
    assert "stays inside" in extrapolation_text(Extrapolation(0.8, {"fastest": 0.8}))


def test_of_commands_the_one_farthest_out_is_named() -> None:
    ratios = {"command port astern": 1.3, "command port astern, moving ahead": 1.6, "yaw_rate": 1.2}
    assert extrapolation_text(Extrapolation(1.6, ratios)) == (
        "1.6: the run commands port astern, moving ahead, further than any training run, with 1.2 times the yaw rate. "
        "Read its intervals as lower limits."
    )


def test_a_slow_run_is_said_to_be_slow() -> None:
    assert extrapolation_text(Extrapolation(2.0, {"fastest": 0.5, "slowest": 2.0})) == (
        "2.0: the run slows to 1/2.0 of the lowest speed of any training run. Read its intervals as lower limits."
    )
