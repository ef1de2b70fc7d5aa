"""Extrapolation in words: inside the training runs, at their edge, beyond."""

import math

import pytest

from seatrial.core.results import Extrapolation
from seatrial.reporting.measures import extrapolation_text, extrapolation_zone


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
