"""What drives a craft that steers by one angle: a shaft ahead of a rudder, or a thruster that is turned."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.data.draft.test_draft import write
from tests.onboard.sentences import sentence

from seatrial.api import draft_trial
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.draft_text import thruster_tables
from seatrial.data.draft.guess import guess_columns, with_turned_thruster
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.draft.survey import survey_log


def guesses(path: Path, *rates: str) -> dict[str, ColumnGuess]:
    lines = []
    for k in range(60):
        angle = 10.0 * np.sin(0.2 * k)
        lines += [f"GPZDA,1000{k:02d}.00,14,09,2026,00,00", f"HEHDT,{40.0 + angle:.1f},T", f"AGRSA,{angle:.1f},A,,V"]
        lines += [f"ERRPM,{one},{140.0 + 0.1 * k:.1f},100.0,A" for one in rates]
    path.write_bytes(b"".join(map(sentence, lines)))
    return {one.symbol: one for one in guess_columns(survey_log(path)) if one.is_used}


def test_the_only_shaft_is_the_propellers(tmp_path: Path) -> None:
    found = guesses(tmp_path / "day.nmea", "S,1")
    assert {"delta", "n"} <= set(found) and "rpm_1" not in found
    assert found["n"].unit == "rps" and any("the only shaft" in one for one in found["n"].evidence)


def test_two_shafts_beside_a_rudder_are_half_their_sum_and_an_engine_is_none(tmp_path: Path) -> None:
    twin = guesses(tmp_path / "twin.nmea", "S,1", "S,2")
    assert (twin["n"].source, twin["n"].twin) == ("RPM/S1", "RPM/S2") and "rpm_1" not in twin
    assert not {"n", "rpm_1"} & set(guesses(tmp_path / "engine.nmea", "E,1"))


def test_an_angle_that_turns_the_only_thruster_is_the_direction_of_its_thrust() -> None:
    """One that turns the craft to starboard pushes the stern to port."""
    steering = ColumnGuess("steering_deg", "delta", "deg", evidence=("a positive one turns to starboard",))
    throttle, other = ColumnGuess("throttle_pct", "command_1", "percent"), ColumnGuess("thr_2", "command_2", "percent")
    ((turned, _),) = with_turned_thruster([(steering, throttle)])
    assert (turned.symbol, turned.positive) == ("alpha_1", "port")
    ((back, _),) = with_turned_thruster([(replace(steering, positive="port"), throttle)])
    assert (back.symbol, back.positive) == ("alpha_1", "")
    for kept in ([(steering, throttle, other)], [(steering,)], [(replace(steering, source="rudder"), throttle)]):
        assert with_turned_thruster(kept) == tuple(kept), "which is turned is not known, or nothing is"
    lines = thruster_tables([turned, throttle], StatedSize(5.6))
    assert 'angle = { channel = "alpha_1" }' in lines and any(line.startswith("x = -2.80") for line in lines)


def test_two_shafts_by_their_sides_are_thrusters_where_no_rudder_steers(tmp_path: Path) -> None:
    time = np.arange(60.0)
    columns = {"time": time, "heading_deg": 40.0 + time, "rpm_left": 300.0 + time, "rpm_right": 400.0 - time}
    write(tmp_path / "usv.csv", columns)
    found = {one.symbol: one for one in guess_columns(survey_log(tmp_path / "usv.csv")) if one.is_used}
    assert (found["rpm_1"].source, found["rpm_2"].source) == ("rpm_left", "rpm_right") and "n" not in found
    assert (found["rpm_1"].side, found["rpm_2"].side) == ("port", "starboard")
    write(tmp_path / "ship.csv", columns | {"rudder_deg": 10.0 * np.sin(time)})
    found = {one.symbol: one for one in guess_columns(survey_log(tmp_path / "ship.csv")) if one.is_used}
    assert (found["n"].source, found["n"].twin) == ("rpm_left", "rpm_right") and "rpm_1" not in found


def test_two_rudders_are_half_their_sum_and_their_difference_is_said(tmp_path: Path) -> None:
    time = np.arange(0.0, 120.0, 0.5)
    rudder, generator = 10.0 * np.sign(np.sin(0.1 * time)), np.random.default_rng(2)
    columns = {"time": time, "heading [deg]": np.degrees(np.cumsum(np.cumsum(0.0002 * rudder)))}
    columns |= {"Ruder BB [deg]": rudder + generator.normal(0.0, 0.1, time.size), "Ruder StB [deg]": 0.9 * rudder - 1.0}
    write(tmp_path / "ferry.csv", columns)
    draft = draft_trial(tmp_path / "ferry.csv", length=100.0)
    assert 'channels.delta = { column = "Ruder BB [deg]", twin = "Ruder StB [deg]", unit = "deg" }' in draft.text
    assert "difference is 1 deg (spread 1" in draft.text and "not used: Ruder" not in draft.text
    (record,) = draft.records
    assert record is not None
    np.testing.assert_allclose(np.degrees(record["delta"]), 0.95 * rudder - 0.5, atol=0.3)


def test_a_rudder_that_turns_the_other_way_is_a_question(tmp_path: Path) -> None:
    time = np.arange(0.0, 120.0, 0.5)
    rudder = 10.0 * np.sign(np.sin(0.1 * time))
    columns = {"time": time, "heading [deg]": np.degrees(np.cumsum(np.cumsum(0.0002 * rudder)))}
    write(tmp_path / "ferry.csv", columns | {"rudder port [deg]": rudder, "rudder stbd [deg]": 0.5 - rudder})
    (question,) = draft_trial(tmp_path / "ferry.csv", length=100.0).open_questions
    assert question.symbol == "delta" and "'rudder stbd [deg]' turns the other way" in question.other_reading


def test_two_shafts_that_turn_steadily_do_not_turn_against_each_other(tmp_path: Path) -> None:
    """What noise alone makes of their difference is no question."""
    time, generator = np.arange(0.0, 120.0, 0.5), np.random.default_rng(3)
    rudder = 10.0 * np.sign(np.sin(0.1 * time))
    columns = {"time": time, "heading [deg]": np.degrees(np.cumsum(np.cumsum(0.0002 * rudder))), "rudder [deg]": rudder}
    noise = generator.normal(0.0, 1.0, (2, time.size))
    columns |= {"shaft port [rpm]": 140.0 + noise[0], "shaft stbd [rpm]": 141.0 - 0.5 * noise[0] + noise[1]}
    write(tmp_path / "ferry.csv", columns)
    assert draft_trial(tmp_path / "ferry.csv", length=100.0).open_questions == ()


def test_rates_of_thrusters_whose_commands_are_recorded_are_not_two_more_thrusters(tmp_path: Path) -> None:
    time = np.arange(60.0)
    columns = {"time": time, "heading_deg": 40.0 + time, "rpm_port": 30.0 * time, "rpm_stbd": 300.0 - 4.0 * time}
    columns |= {"throttle_port_pct": 1.5 * time, "throttle_stbd_pct": 90.0 - 1.2 * time}
    write(tmp_path / "usv.csv", columns)
    found = {one.symbol: one for one in guess_columns(survey_log(tmp_path / "usv.csv")) if one.is_used}
    assert {"command_1", "command_2"} <= set(found) and not {"rpm_1", "rpm_2", "n"} & set(found)


def test_the_engine_of_an_outboard_drives_the_thruster_that_turns() -> None:
    """Its gear is in the coefficients; a nozzle is taken so where the rate is not one in all runs."""
    engine = ColumnGuess("engine_rpm", "n", "rpm", evidence=("by its name",), is_used=False, unused_because="a gear")
    angle = ColumnGuess("outboard_angle", "delta", "deg", positive="port")
    ((turned, drive),) = with_turned_thruster([(angle, engine)])
    assert (turned.symbol, drive.symbol, drive.is_used, drive.unused_because) == ("alpha_1", "rpm_1", True, "")
    nozzle = replace(angle, source="nozzle deg")
    assert with_turned_thruster([(nozzle, engine)]) == ((nozzle, engine),)
    ((turned, _),) = with_turned_thruster([(nozzle, engine)], is_rate_steady=False)
    assert turned.symbol == "alpha_1"
    steering = replace(angle, source="steering angle")
    assert with_turned_thruster([(steering, engine)], is_rate_steady=False) == ((steering, engine),)
    lines = thruster_tables([turned, drive], StatedSize(5.6), {"rpm_1": 2880.0})
    assert any(line.startswith('command = { channel = "rpm_1", unit = "rpm", span = 2880 }') for line in lines)


@pytest.mark.parametrize(("apart", "model"), [(0.0, "mmg"), (40.0, "mmg_twin")])
def test_two_rudders_and_shafts_that_act_apart_are_those_of_a_model_with_both(
    tmp_path: Path, apart: float, model: str
) -> None:
    time = np.arange(0.0, 300.0, 1.0)
    rudder = 10.0 * np.sign(np.sin(0.05 * time))
    columns = {
        "time": time,
        "heading [deg]": np.degrees(np.cumsum(np.cumsum(0.0001 * rudder))),
        "u [m/s]": 7.0 + 0 * time,
    }
    columns |= {"v [m/s]": 0.01 * rudder, "rudder port [deg]": rudder, "rudder stbd [deg]": rudder}
    steady, shaft = 130.0 + np.sin(time), apart * np.sign(np.sin(0.03 * time))
    columns |= {"shaft stbd [rpm]": steady - shaft, "shaft port [rpm]": steady + shaft}
    write(tmp_path / "ferry.csv", columns)
    text = draft_trial(tmp_path / "ferry.csv", length=140.0).text
    assert f'name = "{model}"' in text
    assert 'channels.n = { column = "shaft port [rpm]", twin = "shaft stbd [rpm]"' in text
    assert ("y_P = " in text) == (model == "mmg_twin")
    assert ('"twin_screws"' in text) == (model == "mmg_twin")


@pytest.mark.parametrize(
    ("depths", "model", "is_free"),
    [((9.0, 80.0), "mmg_shallow", True), ((9.0, 9.1), "mmg_shallow", False), ((60.0, 80.0), "mmg", False)],
)
def test_a_depth_that_the_ship_feels_is_an_input_and_two_depths_free_its_shares(
    tmp_path: Path, depths: tuple[float, float], model: str, is_free: bool
) -> None:
    time = np.arange(0.0, 300.0, 1.0)
    rudder = 10.0 * np.sign(np.sin(0.05 * time))
    for k, depth in enumerate(depths):
        columns = {"time": time, "heading [deg]": np.degrees(np.cumsum(np.cumsum(0.0001 * rudder)))}
        columns |= {"u [m/s]": 6.0 + 0.1 * np.sin(time + k), "v [m/s]": 0.01 * rudder, "rudder [deg]": rudder}
        columns |= {"shaft [rpm]": 130.0 + np.sin(time), "water depth [m]": depth + 0.1 * np.sin(0.1 * time)}
        write(tmp_path / f"run_{k}.csv", columns)
    text = draft_trial(tmp_path / "run_0.csv", tmp_path / "run_1.csv", length=90.0, draught=6.0).text
    assert f'name = "{model}"' in text
    assert ("channels.depth" in text) == ("shallow" in model)
    assert ('"shallow"]' in text) == ("shallow" in model)
    assert ('"h_N_v"' in text) == is_free
