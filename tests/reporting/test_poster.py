"""Cells of the wheelhouse poster: an interval is shown with as many figures as it needs."""

import pytest

from seatrial.core.results.poster import Basis, Poster, PosterManoeuvre, PosterQuantity
from seatrial.core.text.numbers import DASH
from seatrial.reporting.poster import html, poster_table


@pytest.mark.parametrize(
    ("value", "lower", "upper", "text"),
    [
        (9.03, 6.51, 11.55, "9.0 [6.5, 11.6]"),
        (9.034, 9.004, 9.064, "9.03 [9.00, 9.06]"),
        (9.0341, 9.0316, 9.0366, "9.034 [9.032, 9.037]"),
        (9.0341, 9.03409, 9.03411, "9.034 [within 0.001]"),
        (9.0, 9.0, 9.0, "9.0 [within 0.1]"),
        (9.0, None, None, "9.0"),
    ],
)
def test_interval_is_not_rounded_away(value: float, lower: float | None, upper: float | None, text: str) -> None:
    quantity = PosterQuantity("overshoot_1_deg", value, lower, upper, Basis.MEASURED)
    manoeuvre = PosterManoeuvre("zigzag:10/10", (quantity,))
    sheet = Poster("ship", {"L": 100.0}, 1.0, "mmg", 5.0, 35.0, (manoeuvre,))
    assert poster_table([manoeuvre], sheet).rows[0].cells == ((text, "measured"),)


def test_missing_value_is_a_dash() -> None:
    quantity = PosterQuantity("advance_L", float("nan"), None, None, Basis.PREDICTED)
    manoeuvre = PosterManoeuvre("turning-circle:35", (quantity,))
    sheet = Poster("ship", {"L": 100.0}, 1.0, "mmg", 5.0, 35.0, (manoeuvre,))
    assert poster_table([manoeuvre], sheet).rows[0].cells == ((DASH, "predicted"),)


def test_the_poster_is_a_page_like_the_others_and_runs_nothing() -> None:
    quantity = PosterQuantity("advance_L", 3.1, 3.0, 3.2, Basis.PREDICTED)
    circle = PosterManoeuvre("turning-circle:35", (quantity,))
    text = html(Poster("ship", {"L": 100.0}, 1.0, "mmg", 5.0, 35.0, (circle,)))
    assert "script-src 'none'" in text and "<script" not in text and "unsafe" not in text
    assert "Turning circle 35° to starboard" in text and "prefers-color-scheme: dark" in text
