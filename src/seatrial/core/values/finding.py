"""A finding: one statement of a check or an estimate, with its evidence and what to do."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Severity(StrEnum):
    """How much a finding matters."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class Finding:
    """States one thing about a record, a model or a fit.

    Attributes:
        severity: how much it matters.
        code: short stable identifier, e.g. ``velocity-frame``.
        message: one sentence naming the record and channel.
        evidence: the numbers it rests on.
        advice: what the user can do.
    """

    severity: Severity
    code: str
    message: str
    evidence: str = ""
    advice: str = ""

    @property
    def text(self) -> str:
        """Message and evidence in one line."""
        return f"{self.message} ({self.evidence})" if self.evidence else self.message


def worst_first(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings with the errors first, those of one severity in their order."""
    severities = list(Severity)
    return sorted(findings, key=lambda finding: -severities.index(finding.severity))
