"""Digits follow the standard error; signs, spaces and powers are those of print."""

import math

import pytest

from seatrial.core.text.numbers import duration, estimate_text, exact, fixed, significant


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
