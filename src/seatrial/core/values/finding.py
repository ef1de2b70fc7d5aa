"""Findings: one statement of a check or an estimate, with its evidence, what follows from it and what to do."""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path


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
class FindingKind:
    """What findings of one code have in common, as `findings.toml` holds it.

    Attributes:
        area: heading under which the page on bad fits explains it.
        says: what the finding states.
        advice: what to do, names of commands in backticks; empty: nothing, the finding is a note.
        consequence: what follows where nothing is done.
    """

    area: str
    says: str
    advice: str = ""
    consequence: str = ""


@cache
def finding_kinds() -> dict[str, FindingKind]:
    """Return the kinds of finding by their codes, causes before what they cause."""
    text = Path(__file__).with_name("findings.toml").read_text(encoding="utf-8")
    return {code: FindingKind(**row) for code, row in tomllib.loads(text).items()}


@dataclass(frozen=True)
class Finding:
    """States one thing about a record, a model or a fit.

    Attributes:
        severity: how much it matters.
        code: short stable identifier, e.g. ``wrong-frame``.
        message: one sentence naming the record and channel.
        evidence: the numbers it rests on.
        advice: what the user can do; where it is not given, that of the kind.
        edits: what `seatrial check --fix` changes in the trial file.
    """

    severity: Severity
    code: str
    message: str
    evidence: str = ""
    advice: str = ""
    edits: tuple[TrialEdit, ...] = ()

    def __post_init__(self) -> None:
        if not self.advice and (kind := finding_kinds().get(self.code)):
            object.__setattr__(self, "advice", kind.advice.replace("`", ""))

    @property
    def consequence(self) -> str:
        """What follows where nothing is done; empty of a note."""
        kind = None if self.severity is Severity.INFO else finding_kinds().get(self.code)
        return "" if kind is None else kind.consequence

    @property
    def text(self) -> str:
        """Message and evidence in one line."""
        return f"{self.message} ({self.evidence})" if self.evidence else self.message


def worst_first(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings with the errors first, of one severity causes before what they cause."""
    severities, places = list(Severity), {code: place for place, code in enumerate(finding_kinds())}
    return sorted(findings, key=lambda f: (-severities.index(f.severity), places.get(f.code, len(places))))
