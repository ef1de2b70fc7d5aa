"""Degrees, minutes and seconds with a side of the world, in the ways in which loggers write them."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, RawTable
from seatrial.data.read.formats.text import read_text
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import degrees_of


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


def test_the_side_may_stand_in_the_column_behind_the_angle(tmp_path: Path) -> None:
    rows = ["54 48.7004,N,013 15.2114,W", "5448.7064,N,01315.2204,W", ",,,"]
    path = tmp_path / "nav.csv"
    path.write_text("\n".join(["Latitude,N/S,Longitude,E/W", *rows]), encoding="utf-8")
    (table,) = read_text(path, Layout("text", ColumnSpec("time", "", "s"), (), header_lines=1)).tables
    latitude, longitude = (table.numbers(ColumnSpec(name, name, "deg")) for name in ("Latitude", "Longitude"))
    np.testing.assert_allclose(latitude, [54.0 + 48.7004 / 60.0, 54.0 + 48.7064 / 60.0, np.nan], atol=1e-12)
    np.testing.assert_allclose(longitude, [-13.0 - 15.2114 / 60.0, -13.0 - 15.2204 / 60.0, np.nan], atol=1e-12)
