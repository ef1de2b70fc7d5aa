"""A finding: one statement of a check or an estimate, with its evidence, what follows from it and what to do."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Severity(StrEnum):
    """How much a finding matters."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class TrialEdit:
    """One change of a run's block ``[[records]]`` in a trial file.

    Attributes:
        key: in the block, dotted: ``channels.u.frame``.
        value: as TOML writes it; empty with `exchanged_with`.
        unit: SI unit of a number that the file gives in the channel's own; empty: the value stands as it is.
        exchanged_with: the key with which `key` changes places; one that is absent leaves `key` renamed.
    """

    key: str
    value: str = ""
    unit: str = ""
    exchanged_with: str = ""

    def __str__(self) -> str:
        if self.exchanged_with:
            return f"exchange {self.key} and {self.exchanged_with}"
        return f"{self.key} = {self.value}{f' {self.unit}' if self.unit else ''}"


@dataclass(frozen=True)
class Finding:
    """States one thing about a record, a model or a fit.

    Attributes:
        severity: how much it matters.
        code: short stable identifier, e.g. ``velocity-frame``.
        message: one sentence naming the record and channel.
        evidence: the numbers it rests on.
        advice: what the user can do.
        consequence: what follows where nothing is done.
        edits: what `seatrial check --fix` changes in the trial file.
    """

    severity: Severity
    code: str
    message: str
    evidence: str = ""
    advice: str = ""
    consequence: str = ""
    edits: tuple[TrialEdit, ...] = ()

    @property
    def text(self) -> str:
        """Message and evidence in one line."""
        return f"{self.message} ({self.evidence})" if self.evidence else self.message


def worst_first(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings with the errors first, those of one severity in their order."""
    severities = list(Severity)
    return sorted(findings, key=lambda finding: -severities.index(finding.severity))
