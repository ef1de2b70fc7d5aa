"""Degrees, minutes and seconds with a side of the world, in the ways in which loggers write them."""

from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, RawTable
from seatrial.data.read.degrees_minutes import degrees_of


@pytest.mark.parametrize(
    ("text", "degrees"),
    [
        ("54°06.00049'N", 54.0 + 6.00049 / 60.0),
        ("07°54.00023'W", -(7.0 + 54.00023 / 60.0)),
        ("7 54 36 E", 7.91),
        ("54 06,5 s", -(54.0 + 6.5 / 60.0)),
        ("S 12.5", -12.5),
        ("5406.60N", 54.11),
        ("00754.60E", 7.0 + 54.6 / 60.0),
        ("12.5", None),
        ("N", None),
        ("N 12 S", None),
        ("54°66'N", None),
        ("12.5 knots", None),
    ],
)
def test_an_angle_with_its_side_is_in_degrees(text: str, degrees: float | None) -> None:
    assert degrees_of(text) == (None if degrees is None else pytest.approx(degrees, abs=1e-12))


def test_a_column_of_them_is_numbers_and_other_text_is_not() -> None:
    table = RawTable(Path("log.csv").name, ("lat", "note"), (["54°30'N", "", "54°36'N"], ["a", "b", "c"]))
    assert table.numbers(ColumnSpec("lat", "lat", "deg"))[[0, 2]] == pytest.approx([54.5, 54.6])
    with pytest.raises(InputError, match="is not a number"):
        table.numbers(ColumnSpec("lat", "note", "deg"))
