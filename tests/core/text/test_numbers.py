"""Digits follow the standard error; signs, spaces and powers are those of print."""

import math

import pytest

from seatrial.core.text.numbers import (
    column_texts,
    duration,
    estimate_text,
    exact,
    exponent,
    fixed,
    interval,
    p_value,
    percent,
    power_of_ten,
    raised,
    ratio_text,
    rounded,
    signed_percent,
    significant,
)


@pytest.mark.parametrize(
    ("value", "error", "texts"),
    [
        (-0.0312345, 0.00094, ("−0.03123", "0.00094", "")),
        (12.3456, 0.996, ("12.3", "1.0", "")),
        (1234567.0, 4300.0, ("1\u202f234\u202f600", "4\u202f300", "")),
        (-3.21e-6, 4.4e-8, ("−3.210", "0.044", "\u202f×\u202f10⁻⁶")),
        (0.0, 0.5, ("0.00", "0.50", "")),
    ],
)
def test_estimate_has_the_errors_second_digit(value: float, error: float, texts: tuple[str, str, str]) -> None:
    made = estimate_text(value, error, value - 1.96 * error, value + 1.96 * error)
    assert (made.value, made.error, made.power) == texts


def test_without_an_error_the_value_prints_as_given() -> None:
    assert estimate_text(1025.0, None, None, None).value == "1\u202f025"
    assert estimate_text(1025.0, None, None, None).error == "–"


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.5, "0.5"), (5540.0, "5\u202f540"), (0.0699, "0.0699"), (1e-12, "1\u202f×\u202f10⁻¹²"), (0.0, "0")],
)
def test_given_values_lose_no_digit_and_gain_none(value: float, text: str) -> None:
    assert exact(value) == text


def test_what_is_no_number_is_a_dash() -> None:
    assert fixed(math.nan, 2) == significant(None) == exact(math.inf) == "–"


def test_nothing_is_minus_zero() -> None:
    assert fixed(-0.001, 2) == "0.00"


def test_durations() -> None:
    assert duration(3.14159) == "3.14 s"
    assert duration(2068.4) == "34 min 28 s"
    assert [duration(s) for s in (119.0, 125.0, 4000.0, 200000.0)] == [
        "119 s", "2 min 05 s", "1 h 06 min", "2 d 07 h"
    ]  # fmt: skip


def test_shares_and_probabilities() -> None:
    assert [percent(share) for share in (0.123, 0.00451, 12.0, math.nan)] == ["12", "0.45", "> 999", "–"]
    assert [signed_percent(share) for share in (0.12, -0.008, math.inf)] == ["+12 %", "−0.80 %", "without limit"]
    assert (p_value(0.0123), p_value(1e-9)) == ("p = 0.012", "p < 0.001")
    assert (ratio_text(1.26), ratio_text(math.inf)) == ("1.3", "∞")


def test_columns_share_their_decimals() -> None:
    assert column_texts([0.123, 12.3, None, 45.6]) == ["0.12", "12.30", "–", "45.60"]


def test_intervals_have_both_ends() -> None:
    assert interval(-1.0, 2.345, 1) == "[−1.0, 2.3]"
    assert interval(None, 1.0, 1) == interval(0.0, math.inf, 1) == ""


def test_powers_of_ten() -> None:
    assert power_of_ten(-5) == "\u202f×\u202f10⁻⁵" and raised(12) == "¹²"
    assert (exponent(9.99, 2), exponent(9.94, 2), exponent(-0.05, 1)) == (1, 0, -2)
    assert (rounded(9876.0), rounded(98765.0)) == ("9\u202f900", "9.9\u202f×\u202f10⁴")
