"""A fit as strict JSON: the one source of the documented schema. No NaN, no infinity: null instead."""

import json
from collections.abc import Mapping
from typing import Any

from pydantic import Field

from seatrial.core.results import Fit, Prediction
from seatrial.core.values import Finding
from seatrial.data.folder.fit_entries import (
    Entry,
    FamilyEntry,
    FindingEntry,
    IdentifiabilityEntry,
    NoiseEntry,
    Number,
    RivalEntry,
    RollingEntry,
    SeakeepingEntry,
)


class CoefficientEntry(Entry):
    """One parameter of the model in SI units; the interval is at 95 %. `truth` is absent unless it is known."""

    name: str
    unit: str
    estimate: Number
    standard_error: Number = Field(description="null for a fixed parameter")
    lower: Number
    upper: Number
    fixed: bool
    truth: Number = None


class MeasureEntry(Entry):
    """A manoeuvring measure; the bounds are those of the simulated value at 95 %, null until a method defends them."""

    measured: Number
    simulated: Number
    lower: Number
    upper: Number


class ValidationEntry(Entry):
    """One run that was not fitted, simulated open loop."""

    record: str
    rms: dict[str, Number] = Field(description="psi_deg, position_m, u and v in m/s, r in rad/s, as measured")
    measures: dict[str, MeasureEntry] = Field(description="keys end in _L (ship lengths), _deg or _s")
    extrapolation_index: Number = Field(description="largest of the ratios; up to 1 the run stays inside the training")
    extrapolation: dict[str, Number] = Field(
        description="yaw_rate, drift, rudder, speed of the run over those of the training runs; empty: not known"
    )
    noise_floor: dict[str, Number] = Field(description="rms, keys as in rms, that process noise alone would leave")
    tied_spread: dict[str, Number] = Field(
        description="standard deviation over tied models, keys as in measures and rms"
    )


class FitDocument(Entry):
    """What `--json` writes after `identify` and `demo`."""

    coefficients: list[CoefficientEntry]
    intervals: str = Field(description="by what method the intervals were found, in words")
    validation: list[ValidationEntry]
    identifiability: IdentifiabilityEntry | None = Field(description="what the records can tell; null: not examined")
    noise: NoiseEntry | None = Field(description="criterion of the fit and the noise it allows for; null: not examined")
    candidate_models: list[FamilyEntry] = Field(
        description="models compared over whole runs left out; empty: none declared"
    )
    seakeeping: SeakeepingEntry | None = Field(description="the ship in the waves of the trial; null: none known")
    roll: RollingEntry | None = Field(description="what a roll model's coefficients mean; null: another model")
    baselines: list[RivalEntry] = Field(description="estimators on the same runs, the fit first; empty: not compared")
    findings: list[FindingEntry]
    elapsed_s: float
    versions: dict[str, str]
    seed: int


def _validation(p: Prediction) -> ValidationEntry:
    reach = p.extrapolation
    return ValidationEntry(
        record=p.record,
        rms=dict(p.rms),
        measures={name: MeasureEntry.model_validate(m) for name, m in p.measures.items()},
        extrapolation_index=reach.index if reach else None,
        extrapolation=dict(reach.ratios) if reach else {},
        noise_floor=dict(p.noise_floor),
        tied_spread=dict(p.tied_spread),
    )


def finding_entry(f: Finding) -> FindingEntry:
    """A finding as it stands in JSON."""
    return FindingEntry(severity=f.severity.value, code=f.code, text=f.text, advice=f.advice)


def fit_json(fit: Fit) -> dict[str, Any]:
    """The documented schema, ready for `strict_json`."""
    known, disturbance = fit.identifiability, fit.noise_model
    document = FitDocument(
        coefficients=[CoefficientEntry.model_validate(c) for c in fit.coefficients],
        intervals=fit.method.intervals,
        validation=[_validation(p) for p in fit.validation()],
        identifiability=IdentifiabilityEntry.model_validate(known) if known else None,
        noise=NoiseEntry.model_validate(disturbance) if disturbance else None,
        candidate_models=[FamilyEntry.model_validate(member) for member in fit.candidate_models],
        seakeeping=SeakeepingEntry.model_validate(fit.seakeeping) if fit.seakeeping else None,
        roll=RollingEntry.model_validate(fit.roll) if fit.roll else None,
        baselines=[RivalEntry.model_validate(rival) for rival in fit.baselines],
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
