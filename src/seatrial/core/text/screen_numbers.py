"""Numbers as people read them: true minus signs, a dash where there is none, powers of ten where they are long."""

import math

MINUS, DASH = "\u2212", "\u2013"
SMALLEST, LARGEST = 1e-4, 1e7
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def fixed(value: float, decimals: int) -> str:
    """A number with so many decimals and a true minus sign; a dash where there is none."""
    if not math.isfinite(value):
        return DASH
    nearest = round(value, decimals) + 0.0
    return (MINUS if nearest < 0 else "") + f"{abs(nearest):.{max(decimals, 0)}f}"


def significant(value: float, digits: int) -> str:
    """A number with so many significant digits; a power of ten where it is long."""
    if not math.isfinite(value) or value == 0.0:
        return "0" if value == 0.0 else DASH
    power = exponent(value, digits)
    if SMALLEST <= abs(value) < LARGEST:
        return fixed(value, digits - 1 - power)
    return f"{fixed(value / 10.0**power, digits - 1)} ×10{superscript(power)}"


def percent(share: float) -> str:
    """A share in per cent, two significant digits."""
    if not math.isfinite(share):
        return DASH
    return "> 999" if share > 9.99 else significant(100.0 * share, 2)


def exponent(value: float, digits: int) -> int:
    """Decimal exponent after rounding to so many digits."""
    return int(f"{abs(value):.{digits - 1}e}".partition("e")[2])


def superscript(number: int) -> str:
    """-3 as ⁻³."""
    return str(number).translate(_SUPERSCRIPTS)
