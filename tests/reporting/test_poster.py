"""Cells of the wheelhouse poster: an interval is shown with as many figures as it needs."""

import math
from dataclasses import replace

import pytest

from seatrial.core.results.poster import Basis, MeasuredRun, Poster, PosterManoeuvre, PosterQuantity
from seatrial.core.text.numbers import DASH
from seatrial.reporting.poster import PosterCell, html, poster_table, rudder_rate_text


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
    assert poster_table([manoeuvre], sheet).rows[0].cells == (PosterCell(text, "measured"),)


def test_missing_value_is_a_dash() -> None:
    quantity = PosterQuantity("advance_L", float("nan"), None, None, Basis.PREDICTED)
    manoeuvre = PosterManoeuvre("turning-circle:35", (quantity,))
    sheet = Poster("ship", {"L": 100.0}, 1.0, "mmg", 5.0, 35.0, (manoeuvre,))
    assert poster_table([manoeuvre], sheet).rows[0].cells == (PosterCell(DASH, "predicted"),)


def test_the_poster_is_a_page_like_the_others_and_runs_nothing() -> None:
    quantity = PosterQuantity("advance_L", 3.1, 3.0, 3.2, Basis.PREDICTED)
    circle = PosterManoeuvre("turning-circle:35", (quantity,))
    text = html(Poster("ship", {"L": 100.0}, 1.0, "mmg", 5.0, 35.0, (circle,)))
    assert "script-src 'none'" in text and "<script" not in text and "unsafe" not in text
    assert "Turning circle 35° to starboard" in text and "prefers-color-scheme: dark" in text


def test_the_larger_of_two_runs_is_given_with_the_range_of_both() -> None:
    quantity = PosterQuantity("overshoot_1_deg", 21.03, 20.44, 21.65, Basis.MEASURED, repeats=(18.4, 21.03))
    sheet = Poster("ship", {"L": 31.0}, 1.0, "mmg", 6.0, 35.0, ())
    (cell,) = poster_table([PosterManoeuvre("zigzag:20/20", (quantity,))], sheet).rows[0].cells
    assert cell == PosterCell("21.0 [20.4, 21.6]", "measured", "largest of 2 runs, 18.4 to 21.0")


def test_measured_columns_say_what_their_distances_refer_to_at_full_scale() -> None:
    """0.05 m/s in trials at 1:25 are 0.25 m/s at full scale by Froude's law."""
    sheet = Poster("ship", {"L": 4.0}, 25.0, "mmg", 1.0, 35.0, ())
    drifting, still = MeasuredRun("a", 0.05), MeasuredRun("b")
    circles = [PosterManoeuvre("turning-circle:35", (), runs=runs) for runs in ((drifting,), (still,), ())]
    assert [one.measured for one in poster_table(circles, sheet).header] == [
        "measured, corrected for the estimated current of 0.25 m/s", "measured, over ground", ""
    ]  # fmt: skip


def test_the_rudder_rate_is_that_of_the_ship() -> None:
    """SOLAS's 65 deg in 28 s, 2.32 deg/s, are 14.7 deg/s of a model at 1:40."""
    rate = math.radians(65.0 / 28.0)
    model = Poster("ship", {"L": 3.4}, 40.0, "mmg", 1.0, 35.0, (), rate * math.sqrt(40.0), "as SOLAS requires")
    assert rudder_rate_text(model) == "rudder rate 2.32 deg/s, as SOLAS requires"
    assert "14.7" not in html(model)
    assert rudder_rate_text(replace(model, scale=1.0)) == "rudder rate 14.7 deg/s, as SOLAS requires"
