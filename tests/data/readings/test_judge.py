"""The judge of readings: what the columns of one motion show together is taken, what they leave open stays open."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.data.readings import ColumnReading, NamedColumn, ReadingVerdict, Samples, judge, judge_statements
from seatrial.data.readings.terms import Relations

DEGREE = np.pi / 180.0
STEP = 0.2
TIME = STEP * np.arange(2400)
ANGLES = ("psi", "cog", "phi", "theta")


def motion() -> dict[str, Array]:
    """A zigzag, a straight run and a circle by Nomoto's first-order equation; SI, starboard positive."""
    delta = np.where(TIME < 180.0, 0.3 * np.sign(np.sin(0.12 * TIME)), np.where(TIME < 260.0, 0.0, 0.35))
    r, psi = np.zeros(TIME.size), np.zeros(TIME.size)
    for k in range(1, TIME.size):
        r[k] = r[k - 1] + STEP * (0.15 * delta[k - 1] - r[k - 1]) / 6.0
        psi[k] = psi[k - 1] + STEP * r[k - 1]
    u, v = np.full(TIME.size, 4.0) - 20.0 * r**2, -8.0 * r
    velocity = (u + 1j * v) * np.exp(1j * psi)
    track = STEP * np.cumsum(velocity)
    return {"delta": delta, "r": r, "psi": psi, "u": u, "v": v, "x0": track.real, "y0": track.imag,
            "north": velocity.real, "east": velocity.imag}  # fmt: skip


TRUTH = motion()


def column(symbol: str, cells: Array, unit: str = "", frame: str = "") -> NamedColumn:
    return NamedColumn(ColumnReading(symbol, unit, frame), Samples(TIME, cells, symbol in ANGLES))


PLACE = [column("x0", TRUTH["x0"], "m"), column("y0", TRUTH["y0"], "m")]
HEADING = [column("psi", np.mod(TRUTH["psi"] / DEGREE, 360.0))]


def judged(*groups: list[NamedColumn]) -> list[ReadingVerdict]:
    return judge(list(groups))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("unit", "size"), [("rad/s", 1.0), ("deg/s", 1.0 / DEGREE), ("deg/min", 60.0 / DEGREE)])
def test_a_yaw_rate_has_the_unit_and_the_side_of_the_heading(unit: str, size: float, sign: float) -> None:
    verdict = judged(PLACE, HEADING, [column("r", sign * size * TRUTH["r"])])[2]
    (reading,) = verdict.best.readings
    assert (reading.unit, reading.positive) == (unit, "" if sign > 0 else "port") and not verdict.is_open


@pytest.mark.parametrize("is_port", [False, True])
def test_a_rudder_turns_the_craft_to_the_side_it_is_positive_to(is_port: bool) -> None:
    delta = (-1.0 if is_port else 1.0) * TRUTH["delta"] / DEGREE
    verdict = judged(PLACE, HEADING, [column("delta", delta)])[2]
    (reading,) = verdict.best.readings
    assert (reading.unit, reading.positive, verdict.is_open) == ("deg", "port" if is_port else "", False)


@pytest.mark.parametrize("is_port", [False, True])
def test_a_turn_that_slows_under_the_same_rudder_shows_its_side(is_port: bool) -> None:
    """In a circle drift and the loss of speed halve the first yaw rate."""
    over = TIME > 30.0
    since = np.where(over, TIME - 30.0, 0.0)
    r = DEGREE * np.where(over, 0.6 + 0.8 * np.exp(-since / 40.0), 0.0) * (1.0 - np.exp(-since / 10.0))
    psi, delta = np.cumsum(r) * STEP / DEGREE % 360.0, (-35.0 if is_port else 35.0) * over
    verdict = judged([column("psi", psi)], [column("delta", delta)])[1]
    assert (verdict.best.readings[0].positive, verdict.is_open) == ("port" if is_port else "", False)


def test_a_rudder_alone_leaves_its_side_open() -> None:
    (verdict,) = judged([column("delta", TRUTH["delta"] / DEGREE)])
    assert verdict.is_open and verdict.rival is not None and verdict.rival.readings[0].positive == "port"


@pytest.mark.parametrize("frame", ["body", "earth"])
def test_velocities_are_those_that_change_the_position(frame: str) -> None:
    names = {"body": ("u", "v"), "earth": ("north", "east")}[frame]
    velocity = [column(s, TRUTH[name] / 0.514444) for s, name in zip(("u", "v"), names, strict=True)]
    verdict = judged(PLACE, HEADING, velocity)[2]
    assert {(one.frame, one.unit) for one in verdict.best.readings} == {(frame, "kn")} and not verdict.is_open


def test_a_heading_across_the_track_is_asked_for() -> None:
    across = np.mod(TRUTH["psi"] / DEGREE + 90.0, 360.0)
    verdict = judged(PLACE, [column("psi", across)])[1]
    assert verdict.is_open and -90.0 in {one.readings[0].offset for one in (verdict.best, verdict.rival) if one}


def test_a_header_that_the_numbers_contradict_is_asked_for() -> None:
    verdict = judged(PLACE, HEADING, [column("r", TRUTH["r"] / DEGREE, "rad/s")])[2]
    assert verdict.is_open and verdict.best.readings[0].unit == "deg/s" and 'unit = "rad/s"' in verdict.best.contradicts


@pytest.mark.parametrize(("turn", "unit"), [(360.0, "deg"), (2.0 * np.pi, "rad")])
def test_an_angle_has_the_unit_of_the_turn_at_which_it_jumps(turn: float, unit: str) -> None:
    roll = 0.17 * np.exp(-0.01 * TIME) * np.cos(0.8 * TIME) * turn / (2.0 * np.pi)
    (verdict,) = judged([column("phi", np.mod(roll, turn))])
    assert verdict.best.readings[0].unit == unit and not verdict.is_open


def test_roll_of_a_sensor_upside_down_is_half_a_turn_off() -> None:
    roll = 10.0 * np.exp(-0.01 * TIME) * np.cos(0.8 * TIME)
    (verdict,) = judged([column("phi", np.mod(roll, 360.0) - 180.0)])
    assert abs(verdict.best.readings[0].offset) == 180.0


def test_parts_of_a_unit_are_told_by_size() -> None:
    lat, lon = (np.round(1e7 * (a + TRUTH[s] / 111e3)) for a, s in ((-33.8, "x0"), (151.2, "y0")))
    fixes = judged([column("lat", lat), column("lon", lon)], HEADING)[0]
    assert {(one.unit, one.factor) for one in fixes.best.readings} == {("deg", 1e-7)} and not fixes.is_open


PERIODS, PHASES = np.array([6.0, 7.5, 9.0, 11.0]), np.array([0.3, 1.9, 4.0, 5.1])  # s; rad
WAVES = 0.5 * np.cos(np.outer(TIME, 2.0 * np.pi / PERIODS) + PHASES).sum(axis=1)


@pytest.mark.parametrize("is_up", [True, False])
def test_heave_is_positive_to_where_long_waves_lift_the_craft(is_up: bool) -> None:
    heave = judged([column("zeta", WAVES)], [column("z", WAVES if is_up else -WAVES)])[1]
    assert heave.best.readings[0].positive == ("up" if is_up else "") and not heave.is_open
    assert judged([column("z", WAVES)])[0].is_open


@pytest.mark.parametrize(("factor", "count"), [(1.0, 0), (1.0 / DEGREE, 1)])
def test_a_stated_unit_is_refuted_by_the_heading_and_named(factor: float, count: int) -> None:
    cells = {"x0": TRUTH["x0"], "y0": TRUTH["y0"], "psi": TRUTH["psi"], "r": factor * TRUTH["r"]}
    units = {"x0": "m", "y0": "m", "psi": "rad", "r": "rad/s"}
    columns = {s: replace(column(s, values, units[s]), is_stated=True) for s, values in cells.items()}
    judged = judge_statements([[columns["x0"], columns["y0"]], [columns["psi"]], [columns["r"]]])
    assert len(judged.refuted) == count
    for entry in judged.refuted:
        assert entry.best.readings[0].factor == pytest.approx(DEGREE)
        assert entry.reason == "the rate of the heading" and entry.is_only and not judged.is_unexplained


def test_readings_to_the_other_side_answer_the_rudder_with_the_other_sign() -> None:
    signals = {"delta": TRUTH["delta"], "r": TRUTH["r"]}
    plain = Relations((0.5,)).terms
    rudder = next(term for term in plain if "delta" in term.roles[0])
    nats = rudder.nats({slot: (values,) for slot, values in signals.items()})
    assert nats != 0.0
    for side in ("delta", "r"):
        turned = {slot: (-values if slot == side else values,) for slot, values in signals.items()}
        for relations in (plain, Relations((0.5,)).terms):  # what is known of the other side, and nothing
            term = next(one for one in relations if "delta" in one.roles[0])
            assert term.nats(turned) == -nats
