"""Two fits compared: loadings, days, facilities or methods. Differences with intervals, and what else changed."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, computed_field

from seatrial.core.results.fields import Number, ReportedFinding
from seatrial.core.results.summary import Summarised, Summary


@dataclass(frozen=True)
class ComparedFit:
    """What was compared."""

    name: Annotated[str, Field(description="as given, such as its folder")]
    ship: str
    model: str
    criterion: str
    intervals: Annotated[str, Field(description="method of its intervals")]
    records: Annotated[tuple[str, ...], Field(description="names of its training runs")]


@dataclass(frozen=True)
class Difference:
    """One quantity in both fits, and second minus first with its 95 % interval, errors of both fits in it."""

    name: str
    unit: Annotated[str, Field(description="SI; of a measure empty, its name says it")]
    first: Annotated[Number | None, Field(description="its value in the first fit, `unit`")]
    second: Annotated[Number | None, Field(description="and in the second")]
    difference: Annotated[Number | None, Field(description="second minus first")]
    lower: Annotated[Number | None, Field(description="null: one of the fits does not determine it")] = None
    upper: Annotated[Number | None, Field(description="as `lower`")] = None
    is_significant: Annotated[
        bool | None,
        Field(description="whether zero lies outside the joint 95 % interval of its table (Bonferroni); null: unknown"),
    ] = None


@dataclass(frozen=True)
class JointTest:
    """Whether all coefficients that both fits estimate agree (Wald): the difference in its covariance."""

    statistic: Annotated[Number, Field(description="chi-square distributed where the coefficients are the same")]
    degrees_of_freedom: int
    p: Annotated[Number, Field(description="probability of so large a statistic where they are the same")]


@dataclass(frozen=True)
class ManoeuvreDifferences:
    """One manoeuvre steered with both models, each from its own approach condition unless one is stated."""

    manoeuvre: str
    measures: tuple[Difference, ...]
    note: Annotated[str, Field(description="why it could not be compared; empty where it could")] = ""


@dataclass(frozen=True)
class Comparison(Summarised):
    """Two fits compared."""

    first: ComparedFit
    second: ComparedFit
    changes: Annotated[tuple[str, ...], Field(description="what else differs: ship, approach, model, records, method")]
    coefficients: Annotated[tuple[Difference, ...], Field(description="those of the same name and unit, free in both")]
    joint_test: Annotated[JointTest | None, Field(description="null: no coefficient is free in both")]
    manoeuvres: tuple[ManoeuvreDifferences, ...]
    findings: tuple[ReportedFinding, ...]
    versions: Annotated[dict[str, str], Field(description="package -> version")]

    @computed_field(description="quantities whose difference is significant, coefficients first")
    @property
    def significant(self) -> tuple[str, ...]:
        """Return the names of what differs significantly, measures with their manoeuvre."""
        names = [d.name for d in self.coefficients if d.is_significant]
        return (
            *names,
            *(f"{d.name} of {m.manoeuvre}" for m in self.manoeuvres for d in m.measures if d.is_significant),
        )

    def summary(self) -> Summary:
        """Return the differences of the coefficients as a table."""
        rows = tuple((d.name, d.unit, *map(_text, (d.first, d.second, d.difference, d.lower, d.upper)),
                      "yes" if d.is_significant else "") for d in self.coefficients)  # fmt: skip
        header = ("coefficient", "unit", "first", "second", "difference", "lower 95 %", "upper 95 %", "significant")
        facts = {"first": self.first.name, "second": self.second.name}
        return Summary("Two fits compared", header, rows, facts, self.changes)


def _text(value: float | None) -> str:
    return "" if value is None else f"{value:.5g}"
