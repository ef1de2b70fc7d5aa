"""A study: a published paper worked through again, its claims judged. Plain values only."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from seatrial.core.results.fit import Prediction
from seatrial.core.values import Array, Finding, InputError


class Verdict(StrEnum):
    """What became of a claim."""

    CONFIRMED = "confirmed"
    REFUTED = "refuted"
    UNKNOWABLE = "unknowable"


@dataclass(frozen=True)
class Table:
    """A table to print.

    Attributes:
        header: one entry for each column, with its unit.
        rows: text or numbers in the header's units; None prints as a dash.
        note: one sentence below it.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str | float | None, ...], ...]
    note: str = ""


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, the verdict on it and the numbers the verdict rests on."""

    claim: str
    verdict: Verdict
    evidence: str


@dataclass(frozen=True)
class Check:
    """A number held against a limit; `limit` is a number (not to be exceeded) or a range in words."""

    name: str
    value: float
    limit: float | str
    holds: bool


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a figure: x and y of the same shape (n,)."""

    name: str
    x: Array
    y: Array


@dataclass(frozen=True, eq=False)
class Figure:
    """Curves over one pair of axes, labels with units; `is_map` for equal scales (tracks)."""

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    note: str = ""
    is_map: bool = False


@dataclass(frozen=True, eq=False)
class Bars:
    """Grouped bars: a group for each label, in it one bar for each series.

    Attributes:
        series: name -> one value for each label; None where there is none.
        unit: what the axis says, the quantity with its unit.

    Raises:
        InputError: a series has not one value for each label, or a value on a logarithmic axis is negative.
    """

    title: str
    labels: tuple[str, ...]
    series: Mapping[str, tuple[float | None, ...]]
    unit: str
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

    Attributes:
        values: shape (rows, columns); NaN leaves a cell empty.
        limit: magnitude at which the colour is full, 1 for correlations; None for the largest of `values`.

    Raises:
        InputError: `values` has another shape than its names.
    """

    title: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    values: Array
    note: str = ""
    limit: float | None = 1.0

    def __post_init__(self) -> None:
        wanted = (len(self.rows), len(self.columns))
        if self.values.shape != wanted:
            raise InputError(f"matrix '{self.title}': values of shape {self.values.shape} have names for {wanted}")


@dataclass(frozen=True, eq=False)
class Study:
    """A published study repeated, with everything its page shows.

    Attributes:
        name: as in ``seatrial reproduce NAME``, e.g. ``alexandersson2022``.
        source: the paper, with doi.
        title, question, kind: for the head of the page.
        predictions: measured runs beside simulated ones, as in a fit.
        seed, quick, elapsed_s, versions: how to get the same again.
    """

    name: str
    source: str
    claims: tuple[Claim, ...]
    checks: tuple[Check, ...]
    seed: int = 0
    elapsed_s: float = 0.0
    title: str = ""
    question: str = ""
    kind: str = "A published study repeated"
    tables: tuple[Table, ...] = ()
    figures: tuple[Figure | Bars | Matrix, ...] = ()
    predictions: tuple[Prediction, ...] = ()
    findings: tuple[Finding, ...] = ()
    versions: dict[str, str] = field(default_factory=dict)
    quick: bool = False

    def as_table(self) -> dict[str, Any]:
        """As ``reproduce --json`` writes it: study, source, tables, claims, checks, seed, elapsed_s, versions."""
        return {
            "study": self.name,
            "source": self.source,
            "tables": [
                asdict(t) | {"rows": [[_finite_or_none(cell) for cell in row] for row in t.rows]} for t in self.tables
            ],
            "claims": [asdict(claim) for claim in self.claims],
            "checks": [asdict(check) | {"value": _finite_or_none(check.value)} for check in self.checks],
            "seed": self.seed,
            "elapsed_s": self.elapsed_s,
            "versions": dict(self.versions),
        }


def _finite_or_none(cell: str | float | None) -> str | float | None:
    """None for numbers that are none: JSON knows neither NaN nor infinity."""
    return cell if cell is None or isinstance(cell, str) or math.isfinite(cell) else None
