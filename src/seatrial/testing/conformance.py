"""What every conformance check shares: the error, and calls that must refuse or must not fail."""

from collections.abc import Callable
from typing import Any


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
