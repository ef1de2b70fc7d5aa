"""A free-running model in a basin is known by its size and by what its place was measured with."""

from dataclasses import replace

import pytest

from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.draft_text import tables_text
from seatrial.data.draft.ship_estimates import StatedSize, is_in_basin, may_be_in_fresh_water
from seatrial.data.draft.starting_model import StartingModel

TRACK = [ColumnGuess("X", "x0", "m"), ColumnGuess("Y", "y0", "m")]
UNUSED_FIX = replace(ColumnGuess("Lat", "lat", "deg"), is_used=False)
MODEL = StatedSize(3.4)


@pytest.mark.parametrize(
    ("guesses", "size", "expected"),
    [
        (TRACK, MODEL, True),
        (TRACK, StatedSize(12.0), False),
        (TRACK, StatedSize(12.0, scale=25.0), True),
        (TRACK, StatedSize(), False),
        ([*TRACK, UNUSED_FIX], MODEL, False),
        ([*TRACK, ColumnGuess("vn", "u", "m/s", "earth")], MODEL, False),
        ([ColumnGuess("SOG", "sog", "kn")], MODEL, False),
    ],
)
def test_a_small_craft_without_a_receiver_is_in_a_basin(
    guesses: list[ColumnGuess], size: StatedSize, expected: bool
) -> None:
    assert is_in_basin(guesses, size) is expected


def test_the_water_of_small_craft_and_models_is_in_doubt_unless_stated() -> None:
    asked = [
        StatedSize(3.4),
        StatedSize(120.0, scale=30.0),
        StatedSize(62.0),
        StatedSize(3.4, rho=1000.0),
        StatedSize(),
    ]
    assert [may_be_in_fresh_water(size) for size in asked] == [True, True, False, False, False]


def test_no_current_is_drafted_in_a_basin() -> None:
    model = StartingModel("abkowitz", free=("Y_v",), speed=1.0)
    assert "\n# current = 0.3 " in "\n".join(tables_text(model, TRACK, MODEL))
    assert "\ncurrent = 0.3 " in "\n".join(tables_text(model, [*TRACK, UNUSED_FIX], MODEL))


def test_what_is_stated_stands_in_the_file_of_any_model() -> None:
    lines = tables_text(StartingModel("nomoto"), TRACK, StatedSize(3.4, 0.58, 0.21, 265.0, rho=1000.0, scale=40.0))
    keys = [line.partition(" = ")[0] for line in lines if " = " in line]
    assert keys[:7] == ["name", "L", "scale", "B", "d", "m", "rho"]
    assert "ESTIMATED" not in "".join(lines)
