"""Columns of wind that are another wind than their name says are found by the turn of the craft."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.draft.behaviour import tells_wind, wind_readings, with_wind_role
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.naming import APPARENT_WIND

TIME = np.arange(0.0, 400.0, 1.0)
PSI = 0.02 * TIME
SHIP = 6.0 * np.exp(1j * PSI)  # m/s, north + i east
WIND = 9.0 * np.exp(1j * 1.2)  # m/s, to where it comes from


def record(speed: np.ndarray, angle: np.ndarray, names: tuple[str, str]) -> Record:
    track = np.cumsum(SHIP)
    values = {"x0": track.real, "y0": track.imag, "psi": PSI, names[0]: speed, names[1]: angle}
    return Record.from_arrays("run", TIME, values)


RELATIVE, TRUE = ("wind_speed_relative", "wind_direction_relative"), ("wind_speed", "wind_direction")


def decided(speed: np.ndarray, angle: np.ndarray, names: tuple[str, str], other: str = "") -> ColumnGuess | None:
    changes = wind_readings(record(speed, angle, names))
    guess = ColumnGuess("a", names[0], "m/s", other_reading=other)
    return changes[names[0]](guess) if names[0] in changes else None


def test_a_wind_that_is_named_rightly_is_left() -> None:
    apparent = WIND + SHIP
    true = decided(np.abs(WIND) + 0.0 * TIME, np.angle(WIND) + 0.0 * TIME, TRUE)
    assert true is not None and true.evidence == () and true.symbol == "wind_speed"
    left = decided(np.abs(apparent), np.angle(apparent) - PSI, RELATIVE)
    assert left is not None and left.evidence == () and left.unit == "m/s"


def test_a_unit_that_is_open_is_that_of_a_steady_wind() -> None:
    apparent = (WIND + SHIP) * 3600.0 / 1852.0  # kn
    guess = decided(np.abs(apparent), np.angle(apparent) - PSI, RELATIVE, 'unit = "kn"')
    assert guess is not None and guess.unit == "kn" and not guess.is_open


@pytest.mark.parametrize("names", [RELATIVE, TRUE])
def test_a_true_wind_with_an_angle_off_the_bow_is_named(names: tuple[str, str]) -> None:
    guess = decided(np.abs(WIND) + 0.0 * TIME, np.angle(WIND) - PSI, names)
    assert (
        guess is not None and "NOT AS NAMED: as the true wind's speed, with an angle off the bow" in guess.evidence[0]
    )


def test_a_straight_run_says_nothing() -> None:
    straight = record(9.0 + 0.0 * TIME, 1.2 - PSI, RELATIVE)
    assert wind_readings(straight.with_channel("psi", straight.channel("psi").with_values(0.0 * TIME))) == {}
    assert wind_readings(straight.without("x0")) == {}


def test_a_wind_that_is_called_neither_true_nor_apparent_is_what_stays_while_the_craft_turns() -> None:
    apparent = WIND + SHIP
    plain = ColumnGuess("a", "wind_speed", "m/s", other_reading=APPARENT_WIND)
    shown = wind_readings(record(np.abs(apparent), np.angle(apparent) - PSI, TRUE))["wind_speed"](plain)
    assert (shown.symbol, shown.other_reading) == ("wind_speed_relative", "")
    true = wind_readings(record(np.abs(WIND) + 0.0 * TIME, np.angle(WIND) + 0.0 * TIME, TRUE))["wind_speed"](plain)
    assert (true.symbol, true.other_reading) == ("wind_speed", "")
    off_bow = wind_readings(record(np.abs(WIND) + 0.0 * TIME, np.angle(WIND) - PSI, TRUE))["wind_speed"](plain)
    assert off_bow.is_open


def guesses(*symbols: str) -> list[ColumnGuess]:
    return [ColumnGuess(one, one, "rad") for one in symbols]


def test_an_apparent_wind_is_taken_where_the_velocity_over_ground_stands_beside_it() -> None:
    whole = guesses(*RELATIVE, "sog", "cog", "psi")
    assert tells_wind([whole]) and tells_wind([guesses("psi"), guesses(*TRUE)])
    assert not tells_wind([guesses(*RELATIVE, "psi"), guesses("sog", "cog")])
    doubtful = [whole[0].with_evidence("NOT AS NAMED: as the true wind"), *whole[1:]]
    assert not tells_wind([doubtful])
    (taken,), (left,) = with_wind_role([whole], is_taken=True), with_wind_role([whole], is_taken=False)
    assert not any(one.is_commented for one in taken) and "the true wind follows" in taken[0].evidence[-1]
    assert [one.is_commented for one in left] == [True, True, False, False, False]


def test_a_wind_beside_the_one_that_is_used_is_left_for_it() -> None:
    both = guesses(*TRUE, *RELATIVE, "sog", "cog", "psi")
    (read,) = with_wind_role([both], is_taken=True)
    assert [one.is_commented for one in read[:4]] == [False, False, True, True]
    assert read[2].evidence[-1] == "a comment in the file: wind_speed and wind_direction beside it say the wind"
    (calm,) = with_wind_role([both], is_taken=False)
    assert calm[0].evidence[-1] == "a comment in the file: the air is taken for calm"
