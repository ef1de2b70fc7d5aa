"""A study: a published paper worked through again, its claims judged; tables and figures as values, nothing drawn."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, PlainSerializer, WithJsonSchema

from seatrial.core.results.fields import (
    ABSENT,
    Cell,
    ListedArray,
    Number,
    ReportedFinding,
    StoredArray,
    Summarised,
    Summary,
)
from seatrial.core.results.prediction import Prediction
from seatrial.core.values import InputError


@dataclass(frozen=True)
class Table:
    """A table to print."""

    title: str
    header: Annotated[tuple[str, ...], Field(description="one entry for each column, with its unit")]
    rows: Annotated[
        tuple[tuple[Cell, ...], ...], Field(description="text or numbers in the header's units; null prints as a dash")
    ]
    note: Annotated[str, Field(description="one sentence below it")] = ""
    digits: Annotated[int, Field(description="significant digits with which numbers are printed")] = 3


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a figure."""

    name: str
    x: Annotated[StoredArray, Field(description="shape (n,)")]
    y: Annotated[StoredArray, Field(description="shape (n,)")]


@dataclass(frozen=True, eq=False)
class Figure:
    """Curves over one pair of axes."""

    title: str
    x_label: Annotated[str, Field(description="with its unit")]
    y_label: Annotated[str, Field(description="with its unit")]
    curves: tuple[Curve, ...]
    note: str = ""
    is_map: Annotated[bool, Field(description="equal scales on both axes (tracks)")] = False


@dataclass(frozen=True, eq=False)
class Bars:
    """Grouped bars: a group for each label, in it one bar for each series.

    Raises:
        InputError: a series has not one value for each label, or a value on a logarithmic axis is negative.
    """

    title: str
    labels: tuple[str, ...]
    series: Annotated[
        Mapping[str, tuple[Number | None, ...]], Field(description="name -> one value for each label; null: none")
    ]
    unit: Annotated[str, Field(description="label of the axis, the quantity with its unit")]
    note: str = ""
    is_logarithmic: bool = False

    def __post_init__(self) -> None:
        for name, values in self.series.items():
            if len(values) != len(self.labels):
                raise InputError(
                    f"bars '{self.title}': series '{name}' has {len(values)} values for {len(self.labels)} labels"
                )
            if self.is_logarithmic and any(v is not None and v < 0.0 for v in values):
                raise InputError(
                    f"bars '{self.title}': series '{name}' has a negative value, which a logarithmic axis cannot show"
                )


@dataclass(frozen=True, eq=False)
class Matrix:
    """A matrix as coloured cells with numbers, one colour above zero, another below.

    Raises:
        InputError: `values` has another shape than its names.
    """

    title: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    values: Annotated[ListedArray, Field(description="shape (rows, columns); null leaves a cell empty")]
    note: str = ""
    limit: Annotated[
        float | None,
        Field(description="magnitude at which the colour is full, 1 for correlations; null: the largest of `values`"),
    ] = 1.0

    def __post_init__(self) -> None:
        expected = (len(self.rows), len(self.columns))
        if self.values.shape != expected:
            raise InputError(f"matrix '{self.title}': values of shape {self.values.shape} have names for {expected}")


__all__ = ["Bars", "Check", "CheckStatus", "Claim", "Curve", "Figure", "Matrix", "Study", "Table", "Verdict"]


def _absent_if_empty(text: str) -> object:
    return text or ABSENT


_Remark = Annotated[str, PlainSerializer(_absent_if_empty), WithJsonSchema({"type": "string"})]


class Verdict(StrEnum):
    """What became of a claim: unknowable where the print does not decide."""

    CONFIRMED = "confirmed"
    HOLDS_IN_OWN_SETTING = "holds in its own setting"
    REFUTED = "refuted"
    UNKNOWABLE = "unknowable"

    def counted(self, number: int) -> str:
        """Return so many claims with this verdict: ``1 holds in its own setting``, ``6 hold in their own setting``."""
        if self is Verdict.HOLDS_IN_OWN_SETTING and number != 1:
            return f"{number} hold in their own setting"
        return f"{number} {self}"


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and the verdict on it.

    Raises:
        InputError: a claim that holds in its own setting without that setting, or a setting with another verdict.
    """

    claim: str
    verdict: Verdict
    evidence: Annotated[str, Field(description="the numbers the verdict rests on")]
    setting: Annotated[_Remark, Field(description="where a claim holds that holds in its own setting; else absent")] = (
        ""
    )

    def __post_init__(self) -> None:
        if (self.verdict is Verdict.HOLDS_IN_OWN_SETTING) is not bool(self.setting):
            wrong = "has no setting; name it" if not self.setting else "has a setting; leave it out"
            raise InputError(f"claim '{self.claim}' with verdict '{self.verdict}' {wrong}")


class CheckStatus(StrEnum):
    """What became of a check."""

    HOLDS = "holds"
    FAILS = "fails"
    WITHDRAWN = "withdrawn"


@dataclass(frozen=True)
class Check:
    """A number compared with a limit set beforehand; it stays listed whether it holds, fails or is withdrawn."""

    name: str
    value: Number
    limit: Annotated[int | Number | str, Field(description="not to be exceeded, or a range as text")]
    holds: Annotated[bool, Field(description="whether the value keeps the limit")]
    reason: Annotated[_Remark, Field(description="why it fails; absent where that is not known")] = ""
    withdrawal: Annotated[
        _Remark, Field(description="the derivation that shows the limit to be wrong; absent: the check is in force")
    ] = ""

    @classmethod
    def at_most(cls, name: str, value: float, limit: float, reason: str = "") -> Self:
        """Return a check that holds up to its limit; NaN does not hold."""
        return cls(name, float(value), limit, bool(value <= limit), reason)

    @classmethod
    def at_least(cls, name: str, value: float, limit: float, reason: str = "") -> Self:
        """Return a check that holds from its limit upwards; NaN does not hold."""
        return cls(name, float(value), f"at least {limit:g}", bool(value >= limit), reason)

    @classmethod
    def between(cls, name: str, value: float, lower: float, upper: float, reason: str = "") -> Self:
        """Return a check that holds between two limits, both included; NaN does not hold."""
        holds = math.isfinite(value) and lower <= value <= upper
        return cls(name, float(value), f"{lower:g} to {upper:g}", bool(holds), reason)

    @property
    def status(self) -> CheckStatus:
        """Return whether it holds, fails or is withdrawn."""
        if self.withdrawal:
            return CheckStatus.WITHDRAWN
        return CheckStatus.HOLDS if self.holds else CheckStatus.FAILS

    @property
    def remark(self) -> str:
        """Return why it is withdrawn or fails; empty where it holds."""
        if self.status is CheckStatus.FAILS:
            return self.reason or "The reason is not known."
        return self.withdrawal

    def withdrawn(self, derivation: str) -> Self:
        """Return the check as one whose limit the derivation shows to be wrong.

        Raises:
            InputError: no derivation is given.
        """
        if not derivation:
            raise InputError(f"check '{self.name}' is withdrawn without a derivation; say why its limit was wrong")
        return replace(self, withdrawal=derivation)


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
    answer: Annotated[
        tuple[str, ...], Field(description="sentences that answer the question, the most important first; empty: none")
    ] = ()
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
        facts = {"source": self.source, "checks": self.check_counts}
        return Summary(f"Study {self.name}", ("verdict", "claim"), rows, facts)

    @property
    def claim_counts(self) -> str:
        """Return how many claims have which verdict, such as ``2 confirmed, 1 unknowable``."""
        counts = Counter(claim.verdict for claim in self.claims)
        return ", ".join(verdict.counted(counts[verdict]) for verdict in Verdict if counts[verdict])

    @property
    def check_counts(self) -> str:
        """Return how many checks hold, fail and are withdrawn: always all three numbers."""
        counts = Counter(check.status for check in self.checks)
        return (
            f"{counts[CheckStatus.HOLDS]} holding, {counts[CheckStatus.FAILS]} failing, "
            f"{counts[CheckStatus.WITHDRAWN]} withdrawn"
        )
