"""What came of a campaign: how far it is, and what its tasks say together."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, computed_field

from seatrial.core.results.fields import Number, ReportedFinding

ERROR_BINS = 25
"""Bins of a histogram of errors: chosen, odd so that one lies about zero."""
ERROR_RANGE = 5.0
"""Largest error of a histogram, in the unit of its errors: chosen; larger ones count in the last bins."""


@dataclass(frozen=True)
class CampaignStatus:
    """How many tasks of a campaign are done, failed and left."""

    total: int
    done: int
    failed: int
    mean_seconds: Annotated[Number | None, Field(description="wall time of a task that is done, s; null: none is")]
    damaged_places: Annotated[int, Field(description="of journals; the tasks that stood there are worked again")] = 0

    @computed_field(description="tasks that are neither done nor failed")
    @property
    def remaining(self) -> int:
        """Return the number of tasks that are neither done nor failed."""
        return self.total - self.done - self.failed

    @computed_field(description="wall time of the remaining tasks one after the other, s; null: not known")
    @property
    def remaining_seconds(self) -> float | None:
        """Return the wall time that the remaining tasks take one after the other [s]; None where not known."""
        return None if self.mean_seconds is None else self.mean_seconds * self.remaining


@dataclass(frozen=True)
class RepeatedCoefficient:
    """One coefficient over all tasks that estimate it, SI units."""

    name: str
    unit: Annotated[str, Field(description="SI; 1 for a number")]
    count: Annotated[int, Field(description="estimates")]
    mean: Number
    standard_deviation: Annotated[Number, Field(description="of the estimates")]
    quantiles: Annotated[tuple[Number, ...], Field(description="2.5, 25, 50, 75 and 97.5 % of the estimates")]
    truth: Annotated[Number | None, Field(description="null: not known, or not the same in all tasks")]
    rmse: Annotated[Number | None, Field(description="root-mean-square error; null without truth")]
    rmse_over_bound: Annotated[
        Number | None, Field(description="each error over its Cramer-Rao bound, root mean square; null without bounds")
    ]
    intervals: Annotated[int, Field(description="95 % intervals whose truth is known")]
    covered: Annotated[int, Field(description="those that hold it")]
    coverage_interval: Annotated[
        tuple[Number, Number] | None,
        Field(description="95 % interval of the share covered (Clopper and Pearson 1934); null without intervals"),
    ]
    error_counts: Annotated[
        tuple[int, ...],
        Field(description="histogram of errors over the bound (without: deviations from the mean over the standard "
              "deviation), 25 bins from -5 to 5, the outer ones with all beyond"),
    ]  # fmt: skip

    @property
    def coverage(self) -> float | None:
        """Return the share of intervals that hold the truth; None without intervals."""
        return self.covered / self.intervals if self.intervals else None


@dataclass(frozen=True)
class RepeatedScore:
    """One score of held-out runs over all tasks."""

    name: str
    unit: str
    count: int
    median: Number
    mean: Number
    worst: Number


@dataclass(frozen=True)
class FailureReason:
    """Tasks that failed for the same reason."""

    reason: Annotated[str, Field(description="the sentence, its numbers left out")]
    count: int
    example: Annotated[str, Field(description="the sentence of the first one")]
    task: Annotated[str, Field(description="identity of the first one, as in the table")]


@dataclass(frozen=True)
class KeyMap:
    """A quantity over the values of two keys, or of one."""

    quantity: str
    row_key: Annotated[str, Field(description="empty: only one key varies")]
    column_key: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    values: Annotated[tuple[tuple[Number | None, ...], ...], Field(description="rows of columns; null: no result")]


@dataclass(frozen=True)
class CampaignSummary:
    """What the tasks of a campaign say together."""

    question: str
    kind: str
    status: CampaignStatus
    coefficients: tuple[RepeatedCoefficient, ...]
    scores: tuple[RepeatedScore, ...]
    failures: tuple[FailureReason, ...]
    maps: tuple[KeyMap, ...]
    findings: tuple[ReportedFinding, ...]
    processors: Annotated[tuple[str, ...], Field(description="on which the tasks ran")]
    linear_algebra: Annotated[tuple[str, ...], Field(description="libraries that they used")]
    versions: Annotated[dict[str, str], Field(description="package -> version")]
