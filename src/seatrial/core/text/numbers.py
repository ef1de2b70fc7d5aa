"""Numbers as people read them: digits from the standard error, true minus signs, thin spaces, powers of ten."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

MINUS, THIN_SPACE, DASH = "\u2212", "\u202f", "\u2013"
# sizes outside this range are written with a power of ten
LARGEST, SMALLEST = 1e7, 1e-4
# size from which a number of two digits is written with a power of ten
LARGEST_ROUNDED = 1e4
# share from which on a percentage says no more than that it is large
LARGEST_SHARE = 9.99
# p-values below and above which only the bound is written; chosen
SMALLEST_P, LARGEST_P = 0.001, 0.99
SUPERSCRIPTS = dict(zip("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹", strict=True))


@dataclass(frozen=True)
class EstimateText:
    """A value with its standard error and interval as text; `power` is their common factor, mostly empty."""

    value: str
    error: str
    lower: str
    upper: str
    power: str = ""


def fixed(value: float | None, decimals: int) -> str:
    """Return a number with so many decimals (negative: rounded to tens, hundreds, …); a dash where there is none."""
    if value is None or not math.isfinite(value):
        return DASH
    nearest = round(value, decimals) + 0.0
    text = f"{abs(nearest):,.{max(decimals, 0)}f}".replace(",", THIN_SPACE)
    return (MINUS if nearest < 0 else "") + text


def significant(value: float | None, digits: int = 3) -> str:
    """Return a number with so many significant digits, trailing zeros kept; a power of ten where it is long."""
    if value is None or not math.isfinite(value):
        return DASH
    if value == 0:
        return "0"
    power = exponent(value, digits)
    if SMALLEST <= abs(value) < LARGEST:
        return fixed(value, digits - 1 - power)
    return fixed(value / 10.0**power, digits - 1) + power_of_ten(power)


def rounded(value: float) -> str:
    """Return two significant digits; a power of ten from 10 000 on."""
    if not math.isfinite(value) or abs(value) < LARGEST_ROUNDED:
        return significant(value, 2)
    power = exponent(value, 2)
    return fixed(value / 10.0**power, 1) + power_of_ten(power)


def exact(value: float | None, digits: int = 6) -> str:  # more digits than anybody measures, chosen
    """Return a given value as somebody wrote it: up to `digits` significant digits, no trailing zeros."""
    text = significant(value, digits)
    mantissa, times, power = text.partition(THIN_SPACE + "×")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return mantissa + times + power


def estimate_text(value: float, error: float | None, lower: float | None, upper: float | None) -> EstimateText:
    """Return value, standard error and interval with the decimals of the error's second significant digit."""
    if error is None or not math.isfinite(error) or error <= 0 or not math.isfinite(value):
        return EstimateText(exact(value), significant(error, 2), significant(lower), significant(upper))
    largest = max(abs(value), error)
    power = 0 if SMALLEST * 10 <= largest < LARGEST else exponent(largest, 2)
    factor = 10.0**power
    decimals = 1 - exponent(error / factor, 2)

    def text(x: float | None) -> str:
        return fixed(None if x is None else x / factor, decimals)

    return EstimateText(text(value), text(error), text(lower), text(upper), power_of_ten(power) if power else "")


def column_texts(values: Sequence[float | None]) -> list[str]:
    """Return numbers that stand below one another with the same decimals: two digits of the smaller ones."""
    sizes = sorted(abs(v) for v in values if v is not None and math.isfinite(v) and v != 0)
    decimals = max(0, 1 - exponent(sizes[len(sizes) // 4], 2)) if sizes else 0
    return [fixed(v, decimals) for v in values]


def percent(share: float) -> str:
    """Return a share as a number of per cent with two significant digits, ``> 999`` beyond that."""
    if not math.isfinite(share):
        return DASH
    return "> 999" if share > LARGEST_SHARE else significant(100.0 * share, 2)


def signed_percent(share: float) -> str:
    """Return a share in per cent with its sign: ``+12 %``, ``−0.80 %``."""
    if not math.isfinite(share):
        return "without limit"
    return f"{'+' if share > 0 else ''}{significant(100.0 * share, 2)} %"


def p_value(p: float) -> str:
    """Return a p-value with its relation: ``p = 0.012``, ``p < 0.001``, ``p > 0.99``."""
    if p > LARGEST_P:
        return f"p > {LARGEST_P:g}"
    return f"p < {SMALLEST_P:g}" if p < SMALLEST_P else f"p = {significant(p, 2)}"


def ratio_text(ratio: float) -> str:
    """Return a ratio with two digits, ∞ where there is no bound."""
    return "∞" if math.isinf(ratio) else significant(ratio, 2)


def interval(lower: float | None, upper: float | None, decimals: int) -> str:
    """Return an interval: ``[2.83, 3.27]``; empty without both ends."""
    if lower is None or upper is None or not math.isfinite(lower + upper):
        return ""
    return f"[{fixed(lower, decimals)}, {fixed(upper, decimals)}]"


def raised(number: int) -> str:
    """Return a whole number in superscript: ``⁻⁵``."""
    return "".join(SUPERSCRIPTS[sign] for sign in str(number))


def power_of_ten(power: int) -> str:
    """Return a power of ten as a factor: `` × 10⁻⁵``, the spaces thin."""
    return f"{THIN_SPACE}×{THIN_SPACE}10{raised(power)}"


def duration(seconds: float) -> str:
    """Return seconds, from two minutes on minutes and seconds, then hours and minutes, then days and hours."""
    if seconds < 120:  # s, chosen: two minutes
        return f"{significant(seconds, 3)} s"
    minutes, rest = divmod(round(seconds), 60)  # s of a minute
    hours, minutes_left = divmod(minutes, 60)  # minutes of an hour
    if hours == 0:
        return f"{minutes} min {rest:02d} s"
    if hours < 48:  # hours, chosen: two days
        return f"{hours} h {minutes_left:02d} min"
    return f"{hours // 24} d {hours % 24:02d} h"  # hours of a day


def exponent(value: float, digits: int) -> int:
    """Return the decimal exponent after rounding to so many digits: 9.99 with two digits has 1."""
    return int(f"{abs(value):.{digits - 1}e}".partition("e")[2])
