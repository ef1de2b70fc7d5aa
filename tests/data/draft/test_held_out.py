"""The runs that judge a draft's model test it most, and repeat no fitted one where there is another."""

import math
from collections.abc import Mapping

import numpy as np
from tests.reporting.fabricated import zigzag

from seatrial.core.values import Record
from seatrial.data.draft.held_out import held_out_runs
from seatrial.data.draft.starting_model import StartingModel, starting_model

TIME = np.arange(400) * 0.5
SHIP = StartingModel("mmg", inputs=("delta",))
SIMPLE = StartingModel("nomoto", inputs=("delta",))


def steps(rudder_deg: float) -> Record:
    """Steps of the rudder that are no manoeuvre."""
    delta = np.radians(rudder_deg) * np.sign(np.sin(0.2 * TIME))
    return Record.from_arrays("run", TIME, {"delta": delta, "psi": np.zeros(400)})


def turn(rudder_deg: float) -> Record:
    over = TIME > 20.0
    psi = np.cumsum(np.where(over, 0.05 * np.sign(rudder_deg), 0.0)) * 0.5
    return Record.from_arrays("turn", TIME, {"delta": np.where(over, math.radians(rudder_deg), 0.0), "psi": psi})


def decay(angle_deg: float) -> Record:
    return Record.from_arrays("run", TIME, {"phi": np.radians(angle_deg) * np.exp(-0.05 * TIME) * np.cos(TIME)})


def held(model: StartingModel, records: Mapping[str, Record]) -> tuple[str, ...]:
    return held_out_runs(model, records).names


def test_the_upper_middle_run_within_the_others_is_held_out() -> None:
    records = {"a": steps(10.0), "b": steps(20.0), "c": steps(30.0)}
    assert held(SIMPLE, records) == ("a",)  # of two; c leaves what the others show
    assert held(SIMPLE, records | {"d": steps(30.0)}) == ("c",)


def test_no_run_is_held_out_whose_side_no_other_shows() -> None:
    records = {"p": turn(-17.0), "s": turn(17.0)}
    assert held(SIMPLE, records) == () and held(SHIP, records) == ()
    assert held(SIMPLE, {"p": turn(-17.0)}) == ()


def test_repeats_are_held_out_together() -> None:
    records = {"z10": zigzag("z10", 10.0), "z20": zigzag("z20", 20.0), "again": zigzag("again", 20.0)}
    answer = held_out_runs(SIMPLE, records | {"p": turn(-35.0), "s": turn(35.0)})
    assert answer.names == ("z20", "again") and answer.why == ""


def test_a_repeat_that_alone_can_be_held_out_is_called_one() -> None:
    records = {"z20": zigzag("z20", 20.0), "again": zigzag("again", 20.0)}
    answer = held_out_runs(SIMPLE, records)
    assert answer.names == ("z20",) and answer.why.startswith("a repeat of again")


def test_a_model_with_propeller_is_judged_by_the_circles_to_one_side_where_the_others_and_a_zigzag_train_it() -> None:
    zigzags = {"z10": zigzag("z10", 10.0), "z20": zigzag("z20", 20.0)}
    circles = {"p": turn(-35.0), "s": turn(35.0)}
    assert held(SHIP, zigzags | circles) == ("p",)
    assert held(SHIP, zigzags | circles | {"again": turn(-35.0)}) == ("s",), "the side of fewer"
    assert held(SHIP, {"z20": zigzags["z20"]} | circles) == ("p",)
    assert held(SHIP, zigzags | {"s": turn(35.0)}) == ("z20",), "the only circle goes farthest, so that it trains"


def test_the_smaller_of_two_decays_is_held_out_to_whichever_side_it_starts() -> None:
    records = {"large": decay(15.0), "small": decay(-10.0)}
    assert held(starting_model({"phi"}, list(records.values())), records) == ("small",)
