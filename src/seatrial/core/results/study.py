"""A study: a published paper worked through again, its claims judged."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number, ReportedFinding
from seatrial.core.results.prediction import Prediction
from seatrial.core.results.study_figures import Bars, Curve, Figure, Matrix, Table
from seatrial.core.results.summary import Summarised, Summary

__all__ = ["Bars", "Check", "Claim", "Curve", "Figure", "Matrix", "Study", "Table", "Verdict"]


class Verdict(StrEnum):
    """What became of a claim."""

    CONFIRMED = "confirmed"
    REFUTED = "refuted"
    UNKNOWABLE = "unknowable"


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and the verdict on it."""

    claim: str
    verdict: Verdict
    evidence: Annotated[str, Field(description="the numbers the verdict rests on")]


@dataclass(frozen=True)
class Check:
    """A number compared with a limit."""

    name: str
    value: Number
    limit: Annotated[int | Number | str, Field(description="not to be exceeded, or a range as text")]
    holds: bool


@dataclass(frozen=True, eq=False, repr=False)
class Study(Summarised):
    """A published study repeated, with everything its page shows."""

    name: Annotated[str, Field(description="as in `seatrial reproduce NAME`, such as alexandersson2022")]
    source: Annotated[str, Field(description="the paper, with DOI")]
    claims: tuple[Claim, ...]
    checks: tuple[Check, ...]
    seed: int = 0
    elapsed_s: float = 0.0
    title: Annotated[str, Field(description="heads the page")] = ""
    question: str = ""
    kind: Annotated[str, Field(description="stands above the title")] = "A published study repeated"
    tables: tuple[Table, ...] = ()
    figures: tuple[Figure | Bars | Matrix, ...] = ()
    predictions: Annotated[tuple[Prediction, ...], Field(description="measured and simulated runs, as in a fit")] = ()
    findings: tuple[ReportedFinding, ...] = ()
    versions: Annotated[dict[str, str], Field(description="package -> version")] = field(default_factory=dict)
    quick: Annotated[bool, Field(description="with fewer cases")] = False

    def summary(self) -> Summary:
        """Return the claims with their verdicts as a table."""
        rows = tuple((claim.verdict.value, claim.claim) for claim in self.claims)
        holding = sum(check.holds for check in self.checks)
        facts = {"source": self.source, "checks": f"{holding} of {len(self.checks)} hold"}
        return Summary(f"Study {self.name}", ("verdict", "claim"), rows, facts)
