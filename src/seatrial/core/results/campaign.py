"""What came of a campaign, and of methods run against benchmark problems."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, computed_field

from seatrial.core.results.fields import Number, ReportedFinding, Summarised, Summary
from seatrial.core.text.numbers import fixed, significant

# What came of a campaign: how far it is, and what its tasks say together.

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


# What came of methods run against benchmark problems.

_SIGNIFICANCE = 0.05
"""Corrected p-value below which two methods differ, as the intervals have it."""


@dataclass(frozen=True)
class TargetCurve:
    """Empirical distribution of the evaluations to targets, over runs and targets (Hansen et al. 2016, COCO)."""

    evaluations: Annotated[tuple[int, ...], Field(description="in order, of each run and target that was met")]
    total: Annotated[int, Field(description="runs times targets")]


@dataclass(frozen=True)
class MethodScore:
    """One method on one problem."""

    method: str
    is_built_in: bool
    runs: Annotated[int, Field(description="with an answer")]
    failures: Annotated[int, Field(description="runs without one")]
    failure: Annotated[str, Field(description="the sentence of the first; empty: none")]
    errors: Annotated[tuple[Number, ...], Field(description="of all answers, in order of size, in the problem's unit")]
    rms: Annotated[Number | None, Field(description="root mean square of the errors; null without an answer")]
    successes: Annotated[int, Field(description="answers within the problem's limit")]
    evaluations: Annotated[Number | None, Field(description="median over the answers")]
    evaluations_to_success: Annotated[
        Number | None,
        Field(description="evaluations of all runs over successes, as COCO's expected running time; null without one"),
    ]
    targets: TargetCurve
    intervals: Annotated[int, Field(description="95 % intervals that the method stated")]
    covered: Annotated[int, Field(description="those that hold the truth")]
    coverage_interval: Annotated[
        tuple[Number, Number] | None,
        Field(description="95 % interval of the share covered (Clopper and Pearson 1934); null without intervals"),
    ]
    outside: Annotated[int, Field(description="answers outside the box")]
    budget_spent: Annotated[int, Field(description="runs that their budget ended")]
    time_ratio: Annotated[
        Number | None,
        Field(description="median wall time of a run over that of random search; varies by machine and load"),
    ]

    @computed_field(description="middle one of the errors; null without an answer")
    @property
    def median(self) -> float | None:
        """Return the median of the errors, a run without an answer counting as infinite; None without an answer."""
        padded = [*self.errors, *[float("inf")] * self.failures]
        middle = len(padded) // 2
        if not self.errors:
            return None
        return padded[middle] if len(padded) % 2 else 0.5 * (padded[middle - 1] + padded[middle])

    @property
    def coverage(self) -> float | None:
        """Return the share of intervals that hold the truth; None without intervals."""
        return self.covered / self.intervals if self.intervals else None

    @property
    def success_share(self) -> float:
        """Return the share of runs, failed ones included, that succeed."""
        return self.successes / max(self.runs + self.failures, 1)


@dataclass(frozen=True)
class PairedTest:
    """Two methods on the same draws: sign test of which has the smaller error."""

    method: str
    against: str
    smaller: Annotated[int, Field(description="draws on which the method has the smaller error")]
    larger: Annotated[int, Field(description="draws on which it has the larger one, or no answer")]
    p: Annotated[Number, Field(description="of the two-sided sign test")]
    p_adjusted: Annotated[Number, Field(description="for all comparisons of the benchmark, or all claims (Holm 1979)")]

    @computed_field(description="whether the methods differ at the 5 % level after the correction")
    @property
    def is_significant(self) -> bool:
        """Return whether the methods differ at the 5 % level after the correction."""
        return self.p_adjusted < _SIGNIFICANCE

    @property
    def verdict(self) -> str:
        """Return the result in a word or two."""
        if not self.is_significant:
            return "no difference shown"
        return "better" if self.smaller > self.larger else "worse"


@dataclass(frozen=True)
class CheckedClaim:
    """What a paper says of two methods, and the same methods on the same draws."""

    text: str
    test: PairedTest

    @computed_field(description="supported, contradicted, or not shown: the methods do not differ significantly")
    @property
    def verdict(self) -> str:
        """Return what the test says of the claim."""
        return {"better": "supported", "worse": "contradicted"}.get(self.test.verdict, "not shown")


@dataclass(frozen=True)
class ProblemScore:
    """All methods on one problem."""

    name: str
    version: int
    title: str
    source: str
    noise: str
    unknowns: tuple[str, ...]
    budget: Annotated[int, Field(description="evaluations of a run")]
    error_unit: Annotated[str, Field(description="what an error of 1 is")]
    success_limit: Annotated[Number, Field(description="largest error of a success")]
    methods: Annotated[tuple[MethodScore, ...], Field(description="the best median first")]
    tests: tuple[PairedTest, ...]
    claims: Annotated[tuple[CheckedClaim, ...], Field(description="of the problem's paper, where both methods ran")]


@dataclass(frozen=True)
class BenchmarkMethod:
    """A method as it was entered."""

    name: str
    source: str
    digest: Annotated[str, Field(description="SHA-256 of its file, or package and version; empty: of seatrial itself")]
    is_built_in: bool


@dataclass(frozen=True)
class Benchmark(Summarised):
    """Methods against problems. Everything but times is the same to the bit for the same seeds and versions."""

    placement: Annotated[str, Field(description="where the truth lies in its box")]
    seeds: Annotated[tuple[int, int], Field(description="first and last")]
    targets: Annotated[tuple[Number, ...], Field(description="errors over the limit, to which evaluations are counted")]
    status: CampaignStatus
    methods: tuple[BenchmarkMethod, ...]
    problems: tuple[ProblemScore, ...]
    citation: Annotated[str, Field(description="one line that names versions, problems, seeds and methods")]
    findings: tuple[ReportedFinding, ...]
    processors: Annotated[tuple[str, ...], Field(description="on which the runs were made")]
    versions: Annotated[dict[str, str], Field(description="package -> version")]

    def summary(self) -> Summary:
        """Return one row for each problem and method."""
        rows = tuple(
            (p.name, m.method, significant(m.median, 3), significant(m.rms, 3), fixed(100.0 * m.success_share, 0))
            for p in self.problems for m in p.methods
        )  # fmt: skip
        header = ("problem", "method", "median error", "rms error", "success %")
        return Summary("Methods against problems", header, rows, {"seeds": f"{self.seeds[0]} to {self.seeds[1]}"}, ())
