"""What a study of a published paper hands over: its claims, judged, and checks with their limits."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Verdict(StrEnum):
    """What became of a published claim."""

    CONFIRMED = "confirmed"
    REFUTED = "refuted"
    UNKNOWABLE = "unknowable"


@dataclass(frozen=True)
class Claim:
    """A published statement, what we say to it, and the numbers that rests on."""

    claim: str
    verdict: Verdict
    evidence: str


@dataclass(frozen=True)
class Check:
    """A number of ours against its limit."""

    name: str
    value: float
    limit: float
    holds: bool


@dataclass(frozen=True)
class Study:
    """A published study repeated.

    Attributes:
        name: e.g. ``alexandersson2022``.
        source: citation.
    """

    name: str
    source: str
    claims: tuple[Claim, ...]
    checks: tuple[Check, ...]
    seed: int = 0
    elapsed_s: float = 0.0

    def as_table(self) -> dict[str, Any]:
        """Plain tables, as `reproduce --json` writes them: name, source, claims, checks, seed, elapsed_s."""
        return asdict(self)
