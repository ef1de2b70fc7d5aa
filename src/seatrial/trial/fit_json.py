"""A fit as strict JSON: the one source of the documented schema. No NaN, no infinity: null instead."""

import json
import math
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from seatrial.results import Coefficient, Fit, Prediction
from seatrial.values import Finding


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid")


class CoefficientEntry(_Entry):
    """One parameter of the model in SI units; the interval is at 95 %. `truth` is absent unless it is known."""

    name: str
    unit: str
    estimate: float | None
    standard_error: float | None = Field(description="null for a fixed parameter")
    lower: float | None
    upper: float | None
    fixed: bool
    truth: float | None = None


class MeasureEntry(_Entry):
    """A manoeuvring measure; bounds are null until a method defends them."""

    measured: float | None
    simulated: float | None
    lower: float | None
    upper: float | None


class ValidationEntry(_Entry):
    """One run that was not fitted, simulated open loop."""

    record: str
    rms: dict[str, float | None] = Field(description="psi_deg, position_m, u and v in m/s, r in rad/s, as measured")
    measures: dict[str, MeasureEntry] = Field(description="keys end in _L (ship lengths), _deg or _s")


class FindingEntry(_Entry):
    """Something a check or an estimate has to say."""

    severity: str = Field(pattern="^(info|warning|error)$")
    code: str
    text: str
    advice: str


class FitDocument(_Entry):
    """What `--json` writes after `identify` and `demo`."""

    coefficients: list[CoefficientEntry]
    validation: list[ValidationEntry]
    findings: list[FindingEntry]
    elapsed_s: float
    versions: dict[str, str]
    seed: int


def finite(value: float | None) -> float | None:
    """The number, or None where JSON has none."""
    return None if value is None or not math.isfinite(value) else float(value)


def _coefficient(c: Coefficient) -> CoefficientEntry:
    return CoefficientEntry(
        name=c.name,
        unit=c.unit,
        estimate=finite(c.estimate),
        standard_error=finite(c.standard_error),
        lower=finite(c.lower),
        upper=finite(c.upper),
        fixed=c.fixed,
        truth=finite(c.truth),
    )


def _validation(p: Prediction) -> ValidationEntry:
    measures = {
        name: MeasureEntry(
            measured=finite(m.measured), simulated=finite(m.simulated), lower=finite(m.lower), upper=finite(m.upper)
        )
        for name, m in p.measures.items()
    }
    return ValidationEntry(record=p.record, rms={k: finite(v) for k, v in p.rms.items()}, measures=measures)


def finding_entry(f: Finding) -> FindingEntry:
    """A finding as it stands in JSON."""
    return FindingEntry(severity=f.severity.value, code=f.code, text=f.text, advice=f.advice)


def fit_json(fit: Fit) -> dict[str, Any]:
    """The documented schema, ready for `strict_json`."""
    document = FitDocument(
        coefficients=[_coefficient(c) for c in fit.coefficients],
        validation=[_validation(p) for p in fit.validation()],
        findings=[finding_entry(f) for f in fit.findings],
        elapsed_s=fit.elapsed_s,
        versions=fit.versions,
        seed=fit.seed,
    )
    table = document.model_dump()
    for entry in table["coefficients"]:
        if entry["truth"] is None:
            del entry["truth"]
    return table


def findings_json(findings: tuple[Finding, ...]) -> dict[str, Any]:
    """What `check --json` writes."""
    return {"findings": [finding_entry(f).model_dump() for f in findings]}


def strict_json(table: Mapping[str, Any]) -> str:
    """JSON text; a NaN left in the table is a programming error and raises ValueError."""
    return json.dumps(table, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def fit_schema() -> dict[str, Any]:
    """JSON Schema of `fit_json`."""
    return FitDocument.model_json_schema()
