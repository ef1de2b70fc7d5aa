"""Two fits compared: loadings, days, facilities; a published method and the package's own estimate."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.coefficients import Coefficient
from seatrial.core.results.fields import Number, ReportedFinding, Summarised, Summary
from seatrial.core.results.fit import Fit
from seatrial.core.results.published_method import ReferenceEstimate
from seatrial.core.text.numbers import exact, significant
from seatrial.core.text.words import counted

# Two fits compared: loadings, days, facilities or methods. Differences with intervals, and what else changed.


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


# A published method set beside the package's own estimate, as tables of text for terminal and page.

OWN_NAME = "seatrial"
"""What the tables call the package's own estimate."""
# significant digits of estimates, of other numbers
ESTIMATE_DIGITS, _FEW_DIGITS = 5, 3


@dataclass(frozen=True)
class ComparisonTable:
    """Rows of text below a header; the first column is flush left, the others are numbers."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def coefficient_comparison(fit: Fit, reference: ReferenceEstimate) -> ComparisonTable:
    """Return each free coefficient by the method, and by the package with its interval; SI."""
    scatter = fit.search.scatter if fit.search else {}
    compared = {c.name: c for c in reference.coefficients}
    free = [c for c in fit.coefficients if not c.fixed]
    has_truth = any(c.truth is not None for c in free)
    has_intervals = any(compared[c.name].lower is not None for c in free)
    interval_header = ["std. error", "95 % from", "to", "difference/s.e."] if has_intervals else []
    header = ("coefficient", fit.method.name, *(["scatter"] if scatter else []), OWN_NAME, *interval_header,
              *(["known"] if has_truth else []), "unit")  # fmt: skip
    rows = [
        (c.name, exact(c.estimate, ESTIMATE_DIGITS), *([significant(scatter[c.name], 2)] if scatter else []),
         exact(compared[c.name].estimate, ESTIMATE_DIGITS),
         *(_interval_cells(c, compared[c.name]) if has_intervals else ()),
         *([exact(c.truth, ESTIMATE_DIGITS)] if has_truth else []), c.unit if c.unit != "1" else "")
        for c in free
    ]  # fmt: skip
    return ComparisonTable(header, tuple(rows))


def cost_comparison(fit: Fit, reference: ReferenceEstimate) -> ComparisonTable:
    """Return what each estimate took, and how well it simulates the runs held out, or else the training runs."""
    role = "validation" if fit.validation else "training"
    runs = [p.record for p in fit.predictions if p.role == role]
    errors = {p.record: p.rms for p in fit.predictions}
    own_rms, rms = pooled_rms(reference.rms, runs), pooled_rms(errors, runs)
    keys = list(own_rms)
    word = "held-out" if role == "validation" else "training"
    header = ("estimate", "evaluations", "CPU s", *(["weighted rms"] if fit.search else []),
              *(f"{word} {key}" for key in keys))  # fmt: skip
    evaluations, cpu_s, level = _method_cost(fit)
    first = (fit.method.name, evaluations, cpu_s, *([level] if fit.search else []),
             *(exact(rms.get(key), _FEW_DIGITS) for key in keys))  # fmt: skip
    second = (OWN_NAME, str(reference.evaluations), significant(reference.cpu_s, 2),
              *([exact(reference.record_rms, ESTIMATE_DIGITS)] if fit.search else []),
              *(exact(own_rms[key], _FEW_DIGITS) for key in keys))  # fmt: skip
    return ComparisonTable(header, (first, second))


def count_inside_own_intervals(fit: Fit, reference: ReferenceEstimate) -> int:
    """Return how many of the method's values lie inside the 95 % intervals of the package's own estimate."""
    intervals = {c.name: (c.lower, c.upper) for c in reference.coefficients}
    free = [(c.estimate, *intervals[c.name]) for c in fit.coefficients if not c.fixed]
    return sum(a is not None and b is not None and a <= value <= b for value, a, b in free)


def inside_own_intervals(fit: Fit, reference: ReferenceEstimate) -> str:
    """Return how many of the method's values the package's own estimate allows, as a clause."""
    count = sum(not c.fixed for c in fit.coefficients)
    inside = count_inside_own_intervals(fit, reference)
    coefficients = f"{counted(count, 'coefficient')} of {fit.method.name}"
    return f"{inside} of the {coefficients} lie inside the 95 % intervals of {OWN_NAME}"


def pooled_rms(errors: Mapping[str, Mapping[str, float]], runs: Sequence[str]) -> dict[str, float]:
    """Return the root of the mean square of each error over the runs that have it."""
    run_errors = [errors[run] for run in runs if run in errors]
    keys = dict.fromkeys(key for table in run_errors for key in table)
    return {key: float(np.sqrt(np.mean([table[key] ** 2 for table in run_errors if key in table]))) for key in keys}


def _interval_cells(c: Coefficient, reference: Coefficient) -> tuple[str, str, str, str]:
    """Standard error and interval of the package's own estimate, and the method's difference from it."""
    lower, upper = (exact(end, ESTIMATE_DIGITS) for end in (reference.lower, reference.upper))
    return significant(reference.standard_error, 2), lower, upper, _difference(c, reference)


def _difference(c: Coefficient, reference: Coefficient) -> str:
    error = reference.standard_error
    return significant((c.estimate - reference.estimate) / error, 2) if error else ""


def _method_cost(fit: Fit) -> tuple[str, str, str]:
    """Evaluations, processor time and weighted rms of the method."""
    search = fit.search
    if search is None:
        seconds = fit.method.settings.get("processor time, s")
        return str(fit.solution.evaluations), significant(seconds, 2) if isinstance(seconds, float) else "", ""
    level = search.restarts[search.used].record_rms
    return str(search.evaluations), significant(search.cpu_s, 2), exact(level, ESTIMATE_DIGITS)
