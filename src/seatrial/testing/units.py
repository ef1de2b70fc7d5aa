"""Units of parameters and bindings: products of powers of SI units, as in ``kg m^2/s`` or ``1/(s^2 rad^2)``."""

import re

# SI units by symbol (SI brochure 2019), and revolutions per second
_SYMBOLS = ("1", "m", "s", "kg", "rad", "N", "Pa", "J", "W", "K", "A", "V", "rps")
_FACTOR = re.compile(rf"(?:{'|'.join(_SYMBOLS)})(?:\^-?\d+(?:\.\d+)?)?")


def is_unit(text: str) -> bool:
    """Return whether a unit is a product of SI units, divided by one unit or by a product in parentheses."""
    numerator, slash, denominator = text.partition("/")
    if slash and denominator.startswith("(") and denominator.endswith(")"):
        denominator = denominator[1:-1]
    parts = [*numerator.split(" "), *(denominator.split(" ") if slash else [])]
    return all(_FACTOR.fullmatch(part) for part in parts)
