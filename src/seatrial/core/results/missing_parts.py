"""Parts of a finished result that cannot be computed: each is a sentence in its place, and the rest stays."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from seatrial.core.values import Finding, InputError, Severity

Part = TypeVar("Part")

_ERRORS = (InputError, ArithmeticError, ValueError, LookupError, TypeError, AttributeError)
"""Of numbers that lead nowhere (ValueError: of linear algebra, too), and of results that were edited by hand."""


@dataclass
class MissingParts:
    """Notes which parts of a result were left out, and why.

    Attributes:
        findings: one for each part that could not be computed.
    """

    findings: list[Finding] = field(default_factory=list)

    def computed(self, name: str, compute: Callable[[], Part], otherwise: Part) -> Part:
        """Return a part of a result, or what stands for it where it cannot be computed; name: as users know it."""
        try:
            return compute()
        except _ERRORS as error:
            self.findings.append(
                Finding(
                    Severity.WARNING, "part-missing", f"the result is without {name}, which could not be computed",
                    _reason(error), "the rest of the result stands; correct what it names, and repeat",
                )
            )  # fmt: skip
            return otherwise


def _reason(error: Exception) -> str:
    """Return why, in the error's words; with its kind where these were written for no user."""
    return str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
