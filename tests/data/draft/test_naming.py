"""Columns are recognised by names that people give them."""

import pytest

from seatrial.data.draft.naming import guess_by_name


@pytest.mark.parametrize(
    ("name", "symbol", "unit"),
    [
        ("Speed fwd [kn]", "u", "kn"),
        ("Forward speed (m/s)", "u", "m/s"),
        ("Speed stbd [kn]", "v", "kn"),
        ("lateral velocity", "v", ""),
        ("Shaft [rpm]", "n", "rpm"),
    ],
)
def test_speeds_along_and_across_and_the_rate_of_the_shaft_are_recognised(name: str, symbol: str, unit: str) -> None:
    guess = guess_by_name("", name, "")
    assert guess is not None
    assert (guess.symbol, guess.unit) == (symbol, unit)


def test_a_speed_of_the_wind_is_no_speed_of_the_craft() -> None:
    guess = guess_by_name("", "Wind speed fwd", "")
    assert guess is None
