"""A fit as plain tables and back: the part of `result.json` that only a report needs."""

import math
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any, TypeVar, get_type_hints

from pydantic import TypeAdapter, ValidationError

from seatrial.core.results import (
    Coefficient,
    Disturbance,
    Extrapolation,
    Fit,
    Identifiability,
    Measure,
    Member,
    Method,
    Noise,
    Offset,
    Prediction,
    Residuals,
    Rival,
    Rolling,
    Seakeeping,
    Solution,
    Status,
)
from seatrial.core.values import Array, Finding, Record, Severity, Ship
from seatrial.data.folder.archive import record_from
from seatrial.data.folder.model_file import ModelFile

T = TypeVar("T")


def detail_table(fit: Fit, records: list[Record], place: Mapping[int, int]) -> dict[str, Any]:
    """What the documented part leaves out and a report needs."""
    solution = fit.solution
    return {
        "question": fit.question,
        "ship": _plain(
            {
                "name": fit.ship.name,
                "particulars": dict(fit.ship.particulars),
                "source": fit.ship.source,
                "scale": fit.ship.scale,
            }
        ),
        "coefficients": [_plain(c) for c in fit.coefficients],
        "solution": _plain(
            {
                "value": solution.value,
                "status": solution.status.name,
                "evaluations": solution.evaluations,
                "history": solution.history,
                "seed": solution.seed,
            }
        ),
        "method": _plain(fit.method),
        "offsets": [_plain(o) for o in fit.offsets],
        "noise": [_plain(n) for n in fit.noise],
        "residuals": [{"channel": r.channel, "rate": r.rate} for r in fit.residuals],
        "findings": [_plain(f) for f in fit.findings],
        "records": [r.metadata for r in records],
        "used": [place[id(r)] for r in fit.records],
        "predictions": [
            {
                "record": p.record,
                "role": p.role,
                "measured": place[id(p.measured)],
                "simulated": place[id(p.simulated)],
                "rms": _plain(p.rms),
                "measures": {name: _plain(m) for name, m in p.measures.items()},
                "initial_seconds": p.initial_seconds,
                "extrapolation": _nested(p.extrapolation),
                "half_width": list(p.half_width),
                "floor": _nested(p.floor),
                "spread": _nested(p.spread),
            }
            for p in fit.predictions
        ],
        "identifiability": _nested(fit.identifiability),
        "disturbance": _nested(fit.disturbance),
        "family": _nested(fit.family),
        "seakeeping": _nested(fit.seakeeping),
        "rolling": _nested(fit.rolling),
        "rivals": _nested(fit.rivals),
    }


def band_arrays(fit: Fit) -> dict[str, Array]:
    """Half widths of all bands under the names `fit_from` looks for."""
    return {
        f"{_band(k)}/{channel}": half_width
        for k, p in enumerate(fit.predictions)
        for channel, half_width in p.half_width.items()
    }


def _band(prediction: int) -> str:
    return f"prediction{prediction}/half_width"


def _nested(value: Any) -> Any:
    """As `_plain`, but numbers that are none stay known by their names: ``inf``, ``-inf``, ``nan``."""
    if is_dataclass(value) and not isinstance(value, type):
        return _nested(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): _nested(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_nested(inner) for inner in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else str(float(value))
    return value


def _restored(kind: Any, table: Any) -> Any:
    """The value of that type, the inverse of `_nested`; TypeError where the table is damaged."""
    try:
        return TypeAdapter(kind).validate_python(table)
    except ValidationError as error:
        first = error.errors()[0]
        raise TypeError(f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}") from None


def _plain(value: Any) -> Any:
    """Dataclasses, tuples and numbers as JSON has them."""
    if is_dataclass(value) and not isinstance(value, type):
        return _plain(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def _made(kind: type[T], table: Mapping[str, Any]) -> T:
    """A flat dataclass from its table; null in a field that must be a number is NaN."""
    hints = get_type_hints(kind)
    return kind(**{key: math.nan if value is None and hints[key] is float else value for key, value in table.items()})


def fit_from(table: Mapping[str, Any], file: ModelFile, arrays: Mapping[str, Array]) -> Fit:
    """The inverse of `detail_table`: result.json's tables, the model file and the arrays put together again."""
    detail = table["detail"]
    records = [record_from(entry, arrays, f"record{i}") for i, entry in enumerate(detail["records"])]
    solution, method = detail["solution"], detail["method"]
    return Fit(
        question=detail["question"],
        ship=_made(Ship, detail["ship"]),
        model=file.model,
        coefficients=tuple(_made(Coefficient, c) for c in detail["coefficients"]),
        covariance=file.covariance,
        margin=file.margin,
        solution=Solution(
            arrays["solution"],
            _number(solution["value"]),
            Status[solution["status"]],
            solution["evaluations"],
            tuple(_number(h) for h in solution["history"]),
            solution["seed"],
        ),
        method=Method(**{**method, "reasons": tuple(method["reasons"])}),
        offsets=tuple(_made(Offset, o) for o in detail["offsets"]),
        noise=tuple(_made(Noise, n) for n in detail["noise"]),
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
        identifiability=_restored(Identifiability | None, detail.get("identifiability")),
        disturbance=_restored(Disturbance | None, detail.get("disturbance")),
        family=_restored(tuple[Member, ...], detail.get("family", [])),
        seakeeping=_restored(Seakeeping | None, detail.get("seakeeping")),
        rolling=_restored(Rolling | None, detail.get("rolling")),
        rivals=_restored(tuple[Rival, ...], detail.get("rivals", [])),
    )


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _prediction(
    entry: Mapping[str, Any], records: list[Record], arrays: Mapping[str, Array], number: int
) -> Prediction:
    return Prediction(
        record=entry["record"],
        role=entry["role"],
        measured=records[entry["measured"]],
        simulated=records[entry["simulated"]],
        rms={key: _number(value) for key, value in entry["rms"].items()},
        measures={name: _made(Measure, m) for name, m in entry["measures"].items()},
        initial_seconds=entry["initial_seconds"],
        extrapolation=_restored(Extrapolation | None, entry.get("extrapolation")),
        half_width={channel: arrays[f"{_band(number)}/{channel}"] for channel in entry.get("half_width", ())},
        floor=_restored(dict[str, float], entry.get("floor", {})),
        spread=_restored(dict[str, float], entry.get("spread", {})),
    )
