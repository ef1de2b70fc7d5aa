"""Programmes and releases: what their texts mean, and what is said about texts that mean nothing."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres.programme import (
    COUNT,
    TABLE,
    Steering,
    programme,
    release_angle,
    roll_measures,
    rudder_angles,
)

STEERING = Steering(psi=0, r=1, delta=0, sign=1.0, slew_rate=0.05, dt=0.1, approach=0.0, characteristic_time=10.0)


def table(text: str) -> list[float]:
    return np.degrees(programme(text).memory(STEERING)[TABLE:]).round(9).tolist()


def test_zigzag_alternates_from_the_named_side() -> None:
    assert table("zigzag:20/10")[:6] == [20.0, 10.0, -20.0, -10.0, 20.0, 10.0]
    assert table("zigzag:10/5:port")[:4] == [-10.0, -5.0, 10.0, 5.0]


def test_consecutive_zigzags_are_twenty_five_executes() -> None:
    assert programme("consecutive-zigzags").memory(STEERING)[COUNT] == 25
    assert table("consecutive-zigzags:1")[::2] == [10.0, -15.0, 20.0, -25.0, 30.0]


def test_turns_go_to_the_named_side() -> None:
    assert table("turning-circle:35:port") == [-35.0, -540.0]
    assert table("pull-out:20") == [20.0, 360.0]


def test_spiral_goes_there_and_back() -> None:
    orders = table("spiral:15")[1:]
    assert orders == orders[::-1]
    assert orders[: len(orders) // 2 + 1] == [15.0, 10.0, 5.0, 3.0, 1.0, 0.0, -1.0, -3.0, -5.0, -10.0, -15.0]


def test_binary_sequence_is_balanced_and_seeded() -> None:
    orders = np.array(table("prbs:20:5:1")[1:])
    assert len(orders) == 511
    assert sorted(set(orders)) == [-20.0, 20.0]
    assert np.sum(orders) == 20.0
    assert table("prbs:20:5:1") == table("prbs:20:5:1")
    assert table("prbs:20:5:1") != table("prbs:20:5:2")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("zigzag", "write it like zigzag:20/20"),
        ("zigzag:20", "write it like zigzag:20/20"),
        ("zigzag:20/x", "write it like zigzag:20/20"),
        ("zigzag:200/20", "200 is not between 0 and 90"),
        ("zigzag:20/20:left", "'left' is one field too many"),
        ("turning-circle", "write it like turning-circle:35"),
        ("prbs:20:-1", "switching time -1 s is not positive"),
        ("consecutive-zigzags:0", "not between 1 and 50"),
        ("zig-zag:20/20", "known are zigzag:20/20"),
        ("", "known are zigzag:20/20"),
    ],
)
def test_bad_text_is_refused_with_an_example(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        programme(text)


def test_rudder_angles_from_step_means() -> None:
    angles = np.array([0.0, 0.1, 0.2, 0.2, 0.2, 0.1, 0.0, -0.1, -0.15])
    held = 0.5 * (angles[1:] + angles[:-1])
    assert rudder_angles(np.append(held, 0.0)) == pytest.approx(angles, abs=1e-13)


def test_sides_have_their_signs() -> None:
    assert release_angle("release:15") == pytest.approx(math.radians(15.0))
    assert release_angle("release:15:port") == pytest.approx(-math.radians(15.0))


@pytest.mark.parametrize("text", ["zigzag:20/20", "release", "release:x", "release:10:aft", "release:10:port:2"])
def test_other_texts_are_refused_with_an_example(text: str) -> None:
    with pytest.raises(InputError, match=r"known is release:15"):
        release_angle(text)


@pytest.mark.parametrize("text", ["release:0", "release:-3", "release:61", "release:inf"])
def test_impossible_angles_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="not between 0 and 60"):
        release_angle(text)


def test_a_decay_that_ends_early_has_the_measures_that_it_shows() -> None:
    time = 0.05 * np.arange(141)
    record = Record.from_arrays("decay", time, {"phi": 0.2 * np.exp(-0.02 * time) * np.cos(time)})
    shown = roll_measures(record)
    assert list(shown) == ["swing_1_deg"]
    # extremes of exp(-a t) cos(w t): tan(w t) = -a / w
    at = math.pi - math.atan(0.02)
    assert shown["swing_1_deg"] == pytest.approx(math.degrees(-0.2 * math.exp(-0.02 * at) * math.cos(at)), rel=1e-4)


def test_a_record_with_gaps_shows_none() -> None:
    record = Record.from_arrays("decay", 0.1 * np.arange(50), {"phi": np.full(50, np.nan)})
    assert roll_measures(record) == {}
