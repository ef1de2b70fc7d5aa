"""What the conformance checks share: the error, calls that must refuse, units."""

import re
from collections.abc import Callable
from typing import Any

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


class ConformanceError(AssertionError):
    """States what an implementation violates, in one sentence."""


def require(condition: bool, sentence: str) -> None:
    """Raise `ConformanceError` with the sentence unless the condition holds."""
    if not condition:
        raise ConformanceError(sentence)


def require_refusal(call: Callable[[], Any], refusal: type[Exception], occasion: str) -> None:
    """Require that a call raises `refusal`; `occasion` names the bad input.

    Raises:
        ConformanceError: the call returns, or raises another exception.
    """
    try:
        call()
    except refusal:
        return
    except Exception as error:
        raise ConformanceError(
            f"{occasion} raises {type(error).__name__} ({error}); raise {refusal.__name__} with one sentence"
        ) from error
    raise ConformanceError(f"{occasion} is accepted; raise {refusal.__name__} with one sentence")
