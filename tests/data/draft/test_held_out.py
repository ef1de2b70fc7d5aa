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


def test_a_full_manoeuvre_whose_kind_trains_too_is_held_out_before_a_change_of_course() -> None:
    zigzags = {"z15": zigzag("z15", 15.0), "z20": zigzag("z20", 20.0)}
    records = {**zigzags, "turn_1": turn(17.0), "turn_2": turn(17.0), "p": turn(-35.0), "s": turn(35.0)}
    kinds = {"z15": "zigzag", "z20": "zigzag", "turn_1": "turn", "turn_2": "turn", "p": "circle", "s": "circle"}
    assert held_out_runs(SIMPLE, records, kinds).names == ("z15",), "of two the smaller one"
    alone = {name: one for name, one in records.items() if name != "z15"}
    assert held_out_runs(SIMPLE, alone, kinds).names == ("turn_1", "turn_2"), "the only zigzag trains"


def test_a_repeat_that_alone_can_be_held_out_is_called_one() -> None:
    records = {"z20": zigzag("z20", 20.0), "again": zigzag("again", 20.0)}
    answer = held_out_runs(SIMPLE, records)
    assert answer.names == ("z20",) and answer.why.startswith("a repeat of again")


def test_a_model_with_propeller_is_judged_by_the_circles_to_one_side_where_the_others_and_a_zigzag_train_it() -> None:
    zigzags = {"z10": zigzag("z10", 10.0), "z20": zigzag("z20", 20.0)}
    circles = {"p": turn(-35.0), "s": turn(35.0)}
    assert held(SHIP, zigzags | circles) == ("z20",), "as many zigzags: the only circle to a side trains"
    assert held(SHIP, zigzags | circles | {"again": turn(-35.0)}) == ("s",), "the side of fewer"
    assert held(SHIP, {"z20": zigzags["z20"]} | circles) == ("p",)
    assert held(SHIP, zigzags | {"s": turn(35.0)}) == ("z20",), "the only circle goes farthest, so that it trains"


def test_a_ship_is_judged_by_a_zigzag_and_a_circle_where_two_of_each_and_the_largest_circles_train_it() -> None:
    zigzags = {f"z{angle}": zigzag("z", float(angle)) for angle in (12, 15, 20)}
    circles = {"p": turn(-35.0), "s": turn(35.0)}
    assert held(SHIP, zigzags | circles) == ("z15",), "of two circles each is the only one to its side"
    judged = held_out_runs(SHIP, zigzags | circles | {"p20": turn(-20.0)})
    assert judged.names == ("z15", "p20") and judged.has_several
    assert judged.seconds == 400 * 0.5 - 0.5 + zigzags["z15"].duration
    assert judged.seconds_in_all == sum(one.duration for one in (*zigzags.values(), *[circles["p"]] * 3))
    repeats = {"p_again": turn(-35.0), "s_again": turn(35.0)}
    assert held(SHIP, zigzags | circles | repeats) == ("z15",), "without both of a side none of these orders is left"


def craft_run(left: float, right: float, seconds: float = 60.0) -> Record:
    """Two commands that swing about a mean each."""
    time = np.arange(0.0, seconds, 0.5)
    swing = 0.1 * np.sin(time)
    return Record.from_arrays("part", time, {"command_1": left + swing, "command_2": right - swing})


def test_a_craft_with_thrusters_is_judged_by_manoeuvres_of_several_kinds_that_last_a_fifth_to_a_third() -> None:
    model = StartingModel("thrusters", inputs=("command_1", "command_2"))
    kinds = {"circle": (0.8, 0.3), "zigzag": (0.6, 0.7), "straight": (0.5, 0.5)}
    records = {f"{kind}{k}": craft_run(*commands) for k in range(4) for kind, commands in kinds.items()}
    judged = held_out_runs(model, records, {name: name[:-1] for name in records})
    assert {name[:-1] for name in judged.names} == {"circle", "zigzag"}, "on a held course all but errors is corrected"
    assert 0.2 <= judged.seconds / judged.seconds_in_all <= 1.0 / 3.0
    few = {name: one for name, one in records.items() if name[-1] in "01"}
    assert len(held_out_runs(model, few, {name: name[:-1] for name in few}).names) == 1, "of no kind are there three"


def test_the_smaller_of_two_decays_is_held_out_to_whichever_side_it_starts() -> None:
    records = {"large": decay(15.0), "small": decay(-10.0)}
    assert held(starting_model({"phi"}, list(records.values())), records) == ("small",)
