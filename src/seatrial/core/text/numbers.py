"""Numbers as people read them: digits from the standard error, true minus signs, thin spaces, powers of ten."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

MINUS, THIN_SPACE, DASH = "\u2212", "\u202f", "\u2013"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
LARGEST, SMALLEST = 1e7, 1e-4


@dataclass(frozen=True)
class EstimateText:
    """A value with its standard error and interval as text; `power` is their common factor, mostly empty."""

    value: str
    error: str
    lower: str
    upper: str
    power: str = ""


def fixed(value: float | None, decimals: int) -> str:
    """A number with so many decimals (negative: rounded to tens, hundreds, …); a dash where there is none."""
    if value is None or not math.isfinite(value):
        return DASH
    nearest = round(value, decimals) + 0.0
    text = f"{abs(nearest):,.{max(decimals, 0)}f}".replace(",", THIN_SPACE)
    return (MINUS if nearest < 0 else "") + text


def significant(value: float | None, digits: int = 3) -> str:
    """A number with so many significant digits, trailing zeros kept; powers of ten where it is long."""
    if value is None or not math.isfinite(value):
        return DASH
    if value == 0:
        return "0"
    exponent = _exponent(value, digits)
    if SMALLEST <= abs(value) < LARGEST:
        return fixed(value, digits - 1 - exponent)
    return fixed(value / 10.0**exponent, digits - 1) + power_of_ten(exponent)


def rounded(value: float) -> str:
    """Two significant digits; a power of ten from 10 000 on."""
    if not math.isfinite(value) or abs(value) < 1e4:
        return significant(value, 2)
    exponent = _exponent(value, 2)
    return fixed(value / 10.0**exponent, 1) + power_of_ten(exponent)


def exact(value: float | None, digits: int = 6) -> str:
    """A given value as somebody wrote it: up to `digits` significant digits, no trailing zeros."""
    text = significant(value, digits)
    mantissa, times, power = text.partition(THIN_SPACE + "×")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return mantissa + times + power


def estimate_text(value: float, error: float | None, lower: float | None, upper: float | None) -> EstimateText:
    """Value, standard error and interval with the decimals of the error's second significant digit."""
    if error is None or not math.isfinite(error) or error <= 0 or not math.isfinite(value):
        return EstimateText(exact(value), significant(error, 2), significant(lower), significant(upper))
    largest = max(abs(value), error)
    power = 0 if SMALLEST * 10 <= largest < LARGEST else _exponent(largest, 2)
    factor = 10.0**power
    decimals = 1 - _exponent(error / factor, 2)

    def text(x: float | None) -> str:
        return fixed(None if x is None else x / factor, decimals)

    return EstimateText(text(value), text(error), text(lower), text(upper), power_of_ten(power) if power else "")


def column_texts(values: Sequence[float | None]) -> list[str]:
    """Numbers below one another with the same decimals: two significant digits of the smaller ones."""
    known = sorted(abs(v) for v in values if v is not None and math.isfinite(v) and v != 0)
    decimals = max(0, 1 - _exponent(known[len(known) // 4], 2)) if known else 0
    return [fixed(v, decimals) for v in values]


def percent(part: float | None, total: float) -> str:
    """`part` in per cent of `whole`, two significant digits."""
    if part is None or total == 0 or not math.isfinite(part / total):
        return DASH
    share = 100.0 * abs(part / total)
    return "> 999" if share > 999 else significant(share, 2)


def power_of_ten(exponent: int) -> str:
    """`` ×10⁻⁵``."""
    return f"{THIN_SPACE}×{THIN_SPACE}10{str(exponent).translate(SUPERSCRIPTS)}"


def duration(seconds: float) -> str:
    """Seconds, or minutes and seconds from two minutes on."""
    if seconds < 120:
        return f"{significant(seconds, 3)} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s"


def _exponent(value: float, digits: int) -> int:
    """Decimal exponent after rounding to so many digits: 9.99 with two digits has 1."""
    return int(f"{abs(value):.{digits - 1}e}".partition("e")[2])
