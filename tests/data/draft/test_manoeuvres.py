"""Manoeuvres planted in long logs: their kind, their ends, and the mode of the autopilot in which they were."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from tests.data.draft.craft import two_thrusters
from tests.data.draft.test_draft import write
from tests.data.read.samples import dataflash

from seatrial.api import draft_trial
from seatrial.core.values import Array, Record
from seatrial.data.draft.manoeuvres import find_stretches, numbered
from seatrial.data.draft.stretches import (
    LogStretch,
    course_stretches,
    decays,
    elapsed,
    padded,
    smooth_speed,
    spirals,
    stops,
)
from seatrial.physics.manoeuvres.measures import measures

STEP = 0.5  # s


def nomoto(delta: Array, u: Array) -> Record:
    """First-order response to a rudder [rad] at a speed [m/s]."""
    r, psi = np.zeros(delta.size), np.zeros(delta.size)
    for k in range(1, delta.size):
        r[k] = r[k - 1] + STEP * (0.15 * delta[k - 1] - r[k - 1]) / 6.0
        psi[k] = psi[k - 1] + STEP * r[k - 1]
    return Record.from_arrays("run", STEP * np.arange(delta.size), {"delta": delta, "u": u, "psi": psi, "r": r})


def over(time: Array, start: float, stop: float) -> Array:
    return (time >= start) & (time < stop)


TIME = STEP * np.arange(1600)


def turning(record: Record) -> list[LogStretch]:
    return [one for one in course_stretches(record) if one.kind != "straight"]


def test_a_circle_with_a_pull_out_reaches_to_its_end() -> None:
    delta = 0.35 * over(TIME, 100.0, 400.0) - 0.35 * over(TIME, 550.0, 750.0)
    first, second = turning(nomoto(delta, np.full(TIME.size, 4.0)))
    assert (first.name, second.name) == ("circle_starboard_with_pull_out_", "circle_port_with_pull_out_")
    assert first.kind_text == "circle to starboard with pull out"
    assert first.start == pytest.approx(100.0, abs=5.0) and first.stop == pytest.approx(550.0, abs=5.0)
    assert second.start == pytest.approx(550.0, abs=5.0) and second.stop == pytest.approx(800.0, abs=5.0)


def test_a_circle_that_goes_straight_into_the_next_has_no_pull_out() -> None:
    delta = 0.35 * over(TIME, 100.0, 400.0) - 0.35 * over(TIME, 400.0, 800.0)
    assert [one.name for one in turning(nomoto(delta, np.full(TIME.size, 4.0)))] == [
        "circle_starboard_", "circle_port_",
    ]  # fmt: skip


def test_a_turn_without_speed_is_a_spin() -> None:
    delta = 0.35 * over(TIME, 100.0, 300.0) + 0.35 * over(TIME, 500.0, 700.0)
    u = np.where(TIME < 320.0, 0.2, 4.0)
    spin, circle = turning(nomoto(delta, u))
    assert spin.name == "spin_starboard_" and "on the spot" in spin.evidence
    assert circle.name.startswith("circle_starboard_")


def test_a_rudder_that_stands_at_one_angle_after_the_other_is_a_spiral() -> None:
    angles = np.radians([15.0, 10.0, 5.0, 0.0, -5.0, -10.0, -15.0])
    delta = np.concatenate([np.zeros(100), np.repeat(angles, 200), np.zeros(100)])
    noise = np.radians(0.1) * np.random.default_rng(3).standard_normal(delta.size)
    (spiral,) = spirals(nomoto(delta + noise, np.full(delta.size, 4.0)))
    assert spiral.name == "spiral" and "7 angles from 15 to -15 deg" in spiral.evidence
    assert (spiral.start, spiral.stop) == (pytest.approx(50.0, abs=3.0), pytest.approx(750.0, abs=3.0))
    assert spirals(nomoto(0.3 * np.sign(np.sin(0.05 * TIME)), np.full(TIME.size, 4.0))) == []


def courses() -> Record:
    """An autopilot that changes course by 30 deg, back and forth, and holds each course for 300 s with small angles."""
    held = np.repeat(np.radians([4.0, 2.5, 1.0, -0.5, -2.0, -3.5]), 100)
    execute = np.repeat(np.radians([15.0, 0.0, -8.0, 0.0]), 30)
    delta = np.concatenate([np.concatenate([side * execute, held]) for side in (1.0, -1.0, 1.0, -1.0)])
    return nomoto(delta, np.full(delta.size, 4.0))


def test_an_autopilot_whose_rudder_wanders_about_amidships_makes_no_spiral() -> None:
    assert spirals(courses()) == []
    small = nomoto(np.repeat(np.radians([3.5, 2.0, 0.5, -1.0, -2.5, -4.0]), 60), np.full(360, 4.0))
    assert spirals(small) == [], "on the way the heading stays within a few degrees"


def test_no_two_manoeuvres_of_a_log_share_time() -> None:
    """A run that is held out of the estimation lies in no other."""
    found = find_stretches((), courses())
    assert len(found) > 0
    assert all(before.stop <= after.start for before, after in pairwise(found))


@pytest.mark.parametrize(("n", "words"), [(-2.0, "propeller astern"), (0.0, "coasting")])
def test_a_speed_that_falls_to_nothing_is_a_stop(n: float, words: str) -> None:
    u = np.where(TIME < 200.0, 4.0, 4.0 * np.exp(-(TIME - 200.0) / 60.0))
    record = Record.from_arrays("run", TIME, {"u": u, "psi": 0.0 * u, "n": np.where(TIME < 200.0, 4.0, n)})
    (stop,) = stops(record)
    assert stop.start == pytest.approx(200.0, abs=5.0) and stop.stop == pytest.approx(200.0 + 60.0 * np.log(10), abs=5)
    assert words in stop.evidence
    flow = smooth_speed(record)
    assert flow is not None and flow.shape == elapsed(record).shape == padded(record, u).shape


def test_a_roll_that_dies_out_is_a_decay() -> None:
    swing = np.radians(10.0) * np.exp(-(TIME - 100.0) / 60.0) * np.cos((TIME - 100.0) * 2.0 * np.pi / 10.0)
    phi = np.where(TIME < 100.0, 0.0, swing)
    (decay,) = decays(Record.from_arrays("run", TIME, {"phi": phi}))
    assert decay.start == pytest.approx(100.0, abs=5.0) and decay.name == "decay"
    steady = np.radians(10.0) * np.cos(TIME * 2.0 * np.pi / 10.0)
    assert decays(Record.from_arrays("run", TIME, {"phi": steady})) == []


def test_swings_that_people_drive_are_no_part_of_the_decay_that_follows() -> None:
    """They run for 100 s, so that the roll swings to the same angle; then it dies out."""
    size = np.where(TIME < 100.0, 1.0, np.exp(-(TIME - 100.0) / 60.0))
    phi = np.radians(8.0) * size * np.cos(TIME * 2.0 * np.pi / 10.0)
    (decay,) = decays(Record.from_arrays("run", TIME[:600], {"phi": phi[:600]}))
    assert 90.0 <= decay.start <= 105.0 and "from 8.0 deg down" in decay.evidence


def released(time: Array, size_deg: float) -> Array:
    """Held at an angle for 30 s, then rolling out with a period of 10 s, slow forces in its tail."""
    since = time - 30.0
    swing = size_deg * np.exp(-since / 60.0) * np.cos(since * 2.0 * np.pi / 10.0) + 0.6 * np.sin(since / 13.0)
    return np.radians(np.where(since < 0.0, size_deg, swing))


def test_a_decay_with_a_disturbed_tail_is_one_decay_and_the_next_release_another() -> None:
    (decay,) = decays(Record.from_arrays("run", TIME[:500], {"phi": released(TIME[:500], 12.0)}))
    assert decay.stop > 100.0 and decay.start < 40.0
    twice = np.concatenate([released(TIME[:500], 12.0), released(TIME[:500], -9.0)])
    first, second = decays(Record.from_arrays("run", TIME[:1000], {"phi": twice}))
    assert first.stop <= 250.0 and second.start == pytest.approx(280.0, abs=3.0)


def test_straight_runs_inside_a_zigzag_are_not_offered(tmp_path: Path) -> None:
    delta = 0.2 * np.sign(np.sin(0.08 * TIME)) * over(TIME, 0.0, 600.0)
    record = nomoto(delta, np.full(TIME.size, 4.0))
    columns = {"time": TIME, "heading": np.degrees(record["psi"]), "surge": record["u"]}
    (stretches,) = draft_trial(write(tmp_path / "run.csv", columns)).stretches
    zigzag, straight = stretches
    assert zigzag.name == "zigzag1" and straight.start >= zigzag.stop
    assert course_stretches(record)[-1].stop == pytest.approx(TIME[-1], abs=1.0)


def test_of_a_long_log_what_is_on_the_way_between_manoeuvres_is_left_out_first() -> None:
    """Twelve long turns with straight runs between them, and two short zigzags at the end."""
    time = STEP * np.arange(26000)
    turning = np.zeros(time.size)
    for k in range(12):
        turning += 0.02 * (-1) ** k * ((time > 800.0 * k + 300.0) & (time < 800.0 * k + 460.0))
    swing = 0.3 * np.sign(np.sin(0.12 * time))
    turning += np.where(((time > 9900) & (time < 10100)) | ((time > 10500) & (time < 10700)), 0.1 * swing, 0.0)
    r = np.convolve(turning, np.exp(-STEP * np.arange(200) / 5.0) * STEP / 5.0)[: time.size]
    record = Record.from_arrays("run", time, {"psi": np.cumsum(r) * STEP, "r": r, "u": np.full(time.size, 5.0)})
    found = find_stretches((), record)
    assert len(found) <= 16 and sum(one.kind == "zigzag" for one in found) == 2


def test_parts_lie_within_one_mode_and_say_whether_a_controller_was_on(tmp_path: Path) -> None:
    craft = two_thrusters()
    micro = [round(1e6 * t) for t in craft["t"]]
    degrees = np.mod(np.degrees(craft["psi"]), 360.0).tolist()
    rows = [(t, u, psi) for t, u, psi in zip(micro, craft["u"].tolist(), degrees, strict=True)]
    modes = [(0, 0, 0), (micro[500], 10, 10), (micro[520], 4, 4)]
    (tmp_path / "run.bin").write_bytes(dataflash({
        "MODE": ("QBB", "TimeUS,Mode,ModeNum", modes), "XKF1": ("Qff", "TimeUS,VN,Yaw", rows),
    }))  # fmt: skip
    (stretches,) = draft_trial(tmp_path / "run.bin").stretches
    assert all(not one.start < craft["t"][500] < one.stop for one in stretches)
    assert "mode MANUAL: no controller" in stretches[0].evidence
    assert "mode HOLD: a controller is on, its orders follow the motion" in stretches[-1].evidence


def test_a_zigzag_after_a_pull_out_gets_an_approach_and_says_that_it_is_not_steady() -> None:
    """The circle gives up the end of its pull-out; the speed recovers by exp(-t / 60 s)."""
    run = 0.35 * over(TIME, 100.0, 400.0)
    for row in range(920, 1500):  # 460 to 750 s: a zigzag 11/11, each switch by the heading reached
        turned = nomoto(run[: row + 1], np.ones(row + 1))["psi"][[920, row]] if row % 4 == 0 else None
        run[row] = run[row - 1] or 0.2
        if turned is not None and np.sign(run[row]) * (turned[1] - turned[0]) > 0.2:
            run[row] = -run[row]
    u = np.where(TIME < 400.0, np.where(TIME < 100.0, 4.0, 2.0), 4.0 - 2.0 * np.exp(-(TIME - 400.0) / 60.0))
    circle, zigzag = find_stretches((), nomoto(run, u))[1:3]
    assert circle.name.startswith("circle_starboard_with_pull_out") and zigzag.name == "zigzag"
    assert circle.stop == zigzag.start < 460.0 - 10.0
    assert "rudder 11 deg, switched at 13 deg of heading; no steady approach: speed" in zigzag.evidence
    assert "approach" not in circle.evidence


def tracked(record: Record) -> Record:
    """The record with the track of its speed and heading, and no sway."""
    u, psi = record["u"], record["psi"]
    x0, y0 = (STEP * np.cumsum(u * turned(psi)) for turned in (np.cos, np.sin))
    channels = {"delta": record["delta"], "u": u, "v": 0.0 * u, "r": record["r"], "psi": psi, "x0": x0, "y0": y0}
    return Record.from_arrays("run", record.time, channels)


def zigzag_orders() -> Array:
    """The rudder of a 10/10 zigzag of `nomoto`, put over in 4 s from 200 s on."""
    delta, r, psi, side = np.zeros(TIME.size), 0.0, 0.0, 1.0
    for k in range(1, TIME.size):
        r, psi = r + STEP * (0.15 * delta[k - 1] - r) / 6.0, psi + STEP * r
        side = -side if side * psi > np.radians(10.0) else side
        step = np.clip(side * np.radians(10.0) - delta[k - 1], -np.radians(1.25), np.radians(1.25))
        delta[k] = delta[k - 1] + step if 200.0 <= TIME[k] < 420.0 else 0.0
    return delta


CIRCLE = np.radians(35.0) * np.clip((TIME - 200.0) / 15.0, 0.0, 1.0)


@pytest.mark.parametrize(("delta", "name"), [(CIRCLE, "circle"), (zigzag_orders(), "zigzag")])
def test_a_part_shows_the_approach_so_that_its_measures_are_those_of_the_log(delta: Array, name: str) -> None:
    record = tracked(nomoto(delta, np.full(TIME.size, 4.0)))
    part = next(one for one in find_stretches((), record) if one.name.startswith(name))
    assert 100.0 < part.start <= 190.0
    of_part, of_log = (measures(one, 100.0) for one in (record.between(part.start, part.stop), record))
    compared = [key for key in of_part if key in of_log]
    assert {"circle": "advance_L", "zigzag": "initial_turning_L"}[name] in compared
    assert [of_part[key] for key in compared] == pytest.approx([of_log[key] for key in compared], rel=0.01)


def test_names_of_several_runs_differ() -> None:
    one = LogStretch("zigzag", 0.0, 10.0, "")
    assert [[s.name for s in run] for run in numbered([[one, one], [one]])] == [["zigzag1", "zigzag2"], ["zigzag3"]]


def test_the_only_log_of_a_craft_with_thrusters_is_cut_in_two_and_nothing_is_left_out(tmp_path: Path) -> None:
    names = {"left": "cmd/port_percent", "right": "cmd/stbd_percent"}
    craft = {
        names.get(name, name): values * (100.0 if name in names else 1.0) for name, values in two_thrusters().items()
    }
    slow = {"yaw [deg]": craft.pop("psi"), "r [deg/s]": craft.pop("r")}  # no turn of it is a circle
    del craft["x0"], craft["y0"]
    write(tmp_path / "session.csv", craft | slow)
    draft = draft_trial(tmp_path / "session.csv", length=2.0)
    (parts,) = draft.parts
    assert [one.name for one in parts] == ["first_part", "last_part"]
    assert parts[0].stop == parts[1].start and parts[0].start == 0.0
    assert len(draft.held_out.names) == 1 and "a third of the manoeuvres" in draft.held_out.why
    held = next(one for one in parts if one.name in draft.held_out.names)
    total = parts[1].stop
    assert (held.stop - held.start) / total == pytest.approx(1.0 / 3.0, abs=0.11)
    record = draft.records[0]
    assert record is not None
    for name in ("command_1", "command_2"):
        inside = (record.time - record.time[0] >= held.start) & (record.time - record.time[0] <= held.stop)
        rest = record[name][~inside]
        slack = 0.25 * np.ptp(rest)
        assert rest.min() - slack <= record[name][inside].min() and record[name][inside].max() <= rest.max() + slack


def test_a_record_at_rest_before_its_release_has_a_decay_from_there(rng: np.random.Generator) -> None:
    """Roll in steps of 0.1 deg, so that its first swings have no angle at all."""
    time = np.arange(0.0, 120.0, 0.1)
    swing = np.where(time < 30.0, 0.0, 10.0 * np.exp(-0.04 * (time - 30.0)) * np.cos(0.785 * (time - 30.0)))
    phi = np.radians(np.round(swing + 0.03 * rng.standard_normal(len(time)), 1))
    (decay,) = decays(Record.from_arrays("run", time, {"phi": phi}))
    assert decay.start == pytest.approx(30.0, abs=1.0), "an eighth of a period"


def course_changes(time: Array, orders: dict[float, float]) -> Array:
    """The heading [deg] that follows changes of course, from s to deg, in small waves and whole degrees."""
    psi = sum(angle * (1.0 - np.exp(-np.maximum(time - at, 0.0) / 6.0)) for at, angle in orders.items())
    return np.mod(np.round(psi + 0.4 * np.sin(0.9 * time)), 360.0)


def test_changes_of_course_are_used_whole_and_a_straight_log_asks_for_a_zigzag(tmp_path: Path) -> None:
    orders = {60.0: 10.0, 160.0: -15.0, 260.0: 30.0, 380.0: 5.0, 460.0: -43.0, 600.0: 20.0}
    rudder = sum(angle * np.exp(-((TIME - at) ** 2) / 20.0) for at, angle in orders.items())
    columns = {"time": TIME, "heading [deg]": course_changes(TIME, orders), "rudder [deg]": rudder}
    draft = draft_trial(write(tmp_path / "log.csv", columns), folder=tmp_path, length=20.0)
    ((first, last),) = draft.parts
    assert (first.start, first.stop, last.stop) == (0.0, last.start, pytest.approx(TIME[-1]))
    assert not draft.lacks_manoeuvre and {one.kind for one in draft.stretches[0]} == {"courses", "straight"}
    straight = columns | {"heading [deg]": course_changes(TIME, {-200.0: 30.0})}
    assert draft_trial(write(tmp_path / "straight.csv", straight), folder=tmp_path, length=20.0).lacks_manoeuvre
