"""A fit as plain tables and back: the part of `result.json` that only a report needs."""

import math
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any, TypeVar, get_type_hints

from pydantic import TypeAdapter, ValidationError

from seatrial.core.results import (
    Baseline,
    CandidateModel,
    Coefficient,
    Extrapolation,
    Fit,
    Identifiability,
    Measure,
    Method,
    Noise,
    NoiseModel,
    Offset,
    Prediction,
    Residuals,
    RollCharacteristics,
    Seakeeping,
    Solution,
    Status,
)
from seatrial.core.values import Array, Finding, Record, Severity, Ship
from seatrial.data.folder.archive import record_from_arrays
from seatrial.data.folder.model_file import ModelFile

T = TypeVar("T")


def detail_table(fit: Fit, records: list[Record], record_index: Mapping[int, int]) -> dict[str, Any]:
    """What the documented part leaves out and a report needs."""
    solution = fit.solution
    return {
        "question": fit.question,
        "ship": _json_value(
            {
                "name": fit.ship.name,
                "particulars": dict(fit.ship.particulars),
                "source": fit.ship.source,
                "scale": fit.ship.scale,
            }
        ),
        "coefficients": [_json_value(c) for c in fit.coefficients],
        "solution": _json_value(
            {
                "value": solution.value,
                "status": solution.status.name,
                "evaluations": solution.evaluations,
                "history": solution.history,
                "seed": solution.seed,
            }
        ),
        "method": _json_value(fit.method),
        "offsets": [_json_value(o) for o in fit.offsets],
        "noise": [_json_value(n) for n in fit.noise],
        "residuals": [{"channel": r.channel, "rate": r.rate} for r in fit.residuals],
        "findings": [_json_value(f) for f in fit.findings],
        "records": [r.metadata for r in records],
        "used": [record_index[id(r)] for r in fit.records],
        "predictions": [
            {
                "record": p.record,
                "role": p.role,
                "measured": record_index[id(p.measured)],
                "simulated": record_index[id(p.simulated)],
                "rms": _json_value(p.rms),
                "measures": {name: _json_value(m) for name, m in p.measures.items()},
                "initial_seconds": p.initial_seconds,
                "extrapolation": _lossless_value(p.extrapolation),
                "half_width": list(p.half_width),
                "noise_floor": _lossless_value(p.noise_floor),
                "tied_spread": _lossless_value(p.tied_spread),
            }
            for p in fit.predictions
        ],
        "identifiability": _lossless_value(fit.identifiability),
        "noise_model": _lossless_value(fit.noise_model),
        "candidate_models": _lossless_value(fit.candidate_models),
        "seakeeping": _lossless_value(fit.seakeeping),
        "roll": _lossless_value(fit.roll),
        "baselines": _lossless_value(fit.baselines),
    }


def band_arrays(fit: Fit) -> dict[str, Array]:
    """Half widths of all bands under the names `fit_from` looks for."""
    return {
        f"{_half_width_prefix(k)}/{channel}": half_width
        for k, p in enumerate(fit.predictions)
        for channel, half_width in p.half_width.items()
    }


def _half_width_prefix(prediction: int) -> str:
    return f"prediction{prediction}/half_width"


def _lossless_value(value: Any) -> Any:
    """As `_plain`, but numbers that are none stay known by their names: ``inf``, ``-inf``, ``nan``."""
    if is_dataclass(value) and not isinstance(value, type):
        return _lossless_value(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): _lossless_value(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_lossless_value(inner) for inner in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else str(float(value))
    return value


def _validated(kind: Any, table: Any) -> Any:
    """The value of that type, the inverse of `_nested`; TypeError where the table is damaged."""
    try:
        return TypeAdapter(kind).validate_python(table)
    except ValidationError as error:
        first = error.errors()[0]
        raise TypeError(f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}") from None


def _json_value(value: Any) -> Any:
    """Dataclasses, tuples and numbers as JSON has them."""
    if is_dataclass(value) and not isinstance(value, type):
        return _json_value(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): _json_value(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_json_value(inner) for inner in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def _flat_dataclass(kind: type[T], table: Mapping[str, Any]) -> T:
    """A flat dataclass from its table; null in a field that must be a number is NaN."""
    hints = get_type_hints(kind)
    return kind(**{key: math.nan if value is None and hints[key] is float else value for key, value in table.items()})


def fit_from_tables(table: Mapping[str, Any], file: ModelFile, arrays: Mapping[str, Array]) -> Fit:
    """The inverse of `detail_table`: result.json's tables, the model file and the arrays put together again."""
    detail = table["detail"]
    records = [record_from_arrays(entry, arrays, f"record{i}") for i, entry in enumerate(detail["records"])]
    solution, method = detail["solution"], detail["method"]
    return Fit(
        question=detail["question"],
        ship=_flat_dataclass(Ship, detail["ship"]),
        model=file.model,
        coefficients=tuple(_flat_dataclass(Coefficient, c) for c in detail["coefficients"]),
        covariance=file.covariance,
        interval_basis=file.interval_basis,
        solution=Solution(
            arrays["solution"],
            _nan_if_null(solution["value"]),
            Status[solution["status"]],
            solution["evaluations"],
            tuple(_nan_if_null(h) for h in solution["history"]),
            solution["seed"],
        ),
        method=Method(**{**method, "reasons": tuple(method["reasons"])}),
        offsets=tuple(_flat_dataclass(Offset, o) for o in detail["offsets"]),
        noise=tuple(_flat_dataclass(Noise, n) for n in detail["noise"]),
        residuals=tuple(
            Residuals(
                r["channel"], r["rate"], arrays[f"residuals/{r['channel']}"], arrays[f"autocorrelation/{r['channel']}"]
            )
            for r in detail["residuals"]
        ),
        predictions=tuple(_prediction(p, records, arrays, k) for k, p in enumerate(detail["predictions"])),
        findings=tuple(Finding(**{**f, "severity": Severity(f["severity"])}) for f in detail["findings"]),
        records=tuple(records[i] for i in detail["used"]),
        seed=table["seed"],
        elapsed_s=table["elapsed_s"],
        versions=table["versions"],
        identifiability=_validated(Identifiability | None, detail.get("identifiability")),
        noise_model=_validated(NoiseModel | None, detail.get("noise_model")),
        candidate_models=_validated(tuple[CandidateModel, ...], detail.get("candidate_models", [])),
        seakeeping=_validated(Seakeeping | None, detail.get("seakeeping")),
        roll=_validated(RollCharacteristics | None, detail.get("roll")),
        baselines=_validated(tuple[Baseline, ...], detail.get("baselines", [])),
    )


def _nan_if_null(value: float | None) -> float:
    return math.nan if value is None else value


def _prediction(
    entry: Mapping[str, Any], records: list[Record], arrays: Mapping[str, Array], number: int
) -> Prediction:
    return Prediction(
        record=entry["record"],
        role=entry["role"],
        measured=records[entry["measured"]],
        simulated=records[entry["simulated"]],
        rms={key: _nan_if_null(value) for key, value in entry["rms"].items()},
        measures={name: _flat_dataclass(Measure, m) for name, m in entry["measures"].items()},
        initial_seconds=entry["initial_seconds"],
        extrapolation=_validated(Extrapolation | None, entry.get("extrapolation")),
        half_width={
            channel: arrays[f"{_half_width_prefix(number)}/{channel}"] for channel in entry.get("half_width", ())
        },
        noise_floor=_validated(dict[str, float], entry.get("noise_floor", {})),
        tied_spread=_validated(dict[str, float], entry.get("tied_spread", {})),
    )
