"""Ship, parameters, provenance, covariances and the basis of intervals as tables of a model file and back."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from seatrial.core.results import IntervalBasis, SessionOffset
from seatrial.core.results.session_offset import KINDS
from seatrial.core.values import Array, InputError, Parameter, Parameters, Prior, Ship, frozen

ROUNDING = 1e-8
"""Negative eigenvalue of a correlation matrix, 1, that rounding of its entries explains."""
ASYMMETRY = 1e-6
"""Difference of two mirrored entries, 1 as a correlation, that rounding explains."""
SMALLEST_VARIANCE = 1e-300
"""Squared unit of the parameter; keeps the scale of a parameter without variance above zero."""
VALUE_TABLES = ("measure_deviation", "offsets", "process", "training_envelope")
EARLIER_KEYS = {"measure_deviation": "kinds", "training_envelope": "covered"}
"""Key today -> key in files that call the table ``margin``."""


def number_table(numbers: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers as Python floats, which are written to the last bit.

    Raises:
        ValueError: one is not finite.
    """
    return {name: finite_number(number, name) for name, number in numbers.items()}


def finite_number(number: Any, name: str) -> float:
    """Return a number of a table as float.

    Raises:
        ValueError: it is no number, or not finite.
    """
    if isinstance(number, bool | str) or not math.isfinite(value := float(number)):
        raise ValueError(f"{name} = {number} is no finite number")
    return value


def matrix_rows(matrix: Array) -> list[list[float]]:
    """Return the rows of a matrix as Python floats."""
    return [[float(cell) for cell in row] for row in matrix]


def interval_basis_table(basis: IntervalBasis) -> dict[str, Any]:
    """Return the table ``interval_basis`` of a model file."""
    return {
        "degrees_of_freedom": float(basis.degrees_of_freedom),
        "factor": float(basis.factor),
        "covariance": matrix_rows(basis.covariance),
        "tied": [number_table(values) for values in basis.tied],
        **{name: number_table(getattr(basis, name)) for name in VALUE_TABLES},
    }


def interval_basis(table: Mapping[str, Any], where: str, parameters: Parameters) -> IntervalBasis | None:
    """Return what a model file holds for intervals of predictions; None where it holds nothing.

    Raises:
        InputError: the covariance is none.
        ValueError: it does not fit the parameters.
    """
    entry = table.get("interval_basis", table.get("margin"))
    if entry is None:
        return None
    degrees, tied = float(entry["degrees_of_freedom"]), tuple(number_table(values) for values in entry["tied"])
    covariance = covariance_matrix(entry["covariance"], f"{where}': interval_basis.covariance")
    if len(covariance) != len(parameters.free):
        raise ValueError(
            f"interval_basis.covariance has {len(covariance)} rows for {len(parameters.free)} free parameters"
        )
    if not degrees > 0.0:
        raise ValueError(f"interval_basis.degrees_of_freedom is {degrees:g}")
    if strangers := [name for values in tied for name in values if name not in parameters]:
        raise ValueError(f"interval_basis.tied names '{strangers[0]}', which is no parameter of the model")
    keys = EARLIER_KEYS if "interval_basis" not in table else {}
    tables = {name: number_table(entry[keys.get(name, name)]) for name in VALUE_TABLES}
    return IntervalBasis(covariance, degrees, float(entry["factor"]), tied=tied, **tables)


def offset_table(offset: SessionOffset) -> dict[str, Any]:
    """Return one table of ``offsets`` of a model file."""
    return {
        "name": offset.name,
        "unit": offset.unit,
        "expected": finite_number(offset.expected, offset.name),
        "sessions": number_table(offset.by_session),
    }


def session_offset(entry: Mapping[str, Any], inputs: Sequence[str], parameters: Parameters) -> SessionOffset:
    """Return an offset of a model file with these inputs and parameters.

    Raises:
        ValueError: it corrects no input in a way that is known, and is no parameter; or a value is not finite.
    """
    offset = SessionOffset(
        str(entry["name"]), str(entry["unit"]), finite_number(entry["expected"], "expected"),
        number_table(entry["sessions"]),
    )  # fmt: skip
    symbol, kind = offset.correction
    if offset.name not in parameters and not (symbol in inputs and kind in KINDS):
        raise ValueError(f"offset '{offset.name}' is of no input or parameter of the model")
    return offset


def covariance_matrix(rows: Sequence[Sequence[float]], where: str) -> Array:
    """Return a covariance, shape (n, n), from the rows of a file.

    Raises:
        InputError: it is not finite, not symmetric, or negative in any direction beyond rounding.
    """
    matrix = np.array(rows, dtype=float).reshape(len(rows), len(rows))
    scale = np.sqrt(np.maximum(np.diag(matrix), SMALLEST_VARIANCE))
    size = np.outer(scale, scale)
    if not np.all(np.isfinite(matrix)) or np.any(np.abs(matrix - matrix.T) > ASYMMETRY * size):
        raise InputError(
            f"model file '{where} is not a symmetric matrix of finite numbers; "
            "write the file again with 'seatrial identify'"
        )
    with np.errstate(over="ignore"):  # beyond 2, however far, it is no correlation
        correlation = np.clip(matrix / size, -2.0, 2.0)
    smallest = float(np.min(np.linalg.eigvalsh(correlation))) if len(rows) else 0.0
    if not smallest > -ROUNDING:
        raise InputError(
            f"model file '{where} is not positive definite (smallest eigenvalue {smallest:.3g} of its correlation "
            "matrix); write the file again with 'seatrial identify'"
        )
    return frozen(matrix)


@dataclass(frozen=True)
class RecordSource:
    """A record behind a model: name, role (``training`` or ``validation``) and SHA-256 of the file it was read from."""

    name: str
    role: str
    sha256: str


@dataclass(frozen=True)
class ModelProvenance:
    """Where a model's values come from.

    Attributes:
        records: every record used.
        method: criterion, in a sentence.
        seed: of the estimate.
        versions: package -> version.
        warnings: of the fit, a sentence each: what holds for every use of the values.
    """

    records: tuple[RecordSource, ...] = ()
    method: str = ""
    seed: int | None = None
    versions: Mapping[str, str] | None = None
    warnings: tuple[str, ...] = ()


def provenance_table(provenance: ModelProvenance) -> dict[str, Any]:
    """Return the table ``provenance`` of a model file."""
    table: dict[str, Any] = {
        "method": provenance.method,
        "versions": dict(provenance.versions or {}),
        "records": [asdict(record) for record in provenance.records],
    }
    if provenance.warnings:
        table["warnings"] = list(provenance.warnings)
    return table if provenance.seed is None else table | {"seed": provenance.seed}


def provenance(table: Mapping[str, Any]) -> ModelProvenance:
    """Return the inverse of `provenance_table`."""
    records = tuple(RecordSource(str(r["name"]), str(r["role"]), str(r["sha256"])) for r in table["records"])
    warnings = tuple(str(text) for text in table.get("warnings", ()))
    return ModelProvenance(records, str(table["method"]), table.get("seed"), dict(table["versions"]), warnings)


def ship_table(ship: Ship) -> dict[str, Any]:
    """Return the table ``ship`` of a model file: particulars by symbol, SI."""
    return {
        "name": ship.name, "source": ship.source, "scale": float(ship.scale), **number_table(ship.particulars)
    }  # fmt: skip


def ship(table: Mapping[str, Any] | None) -> Ship | None:
    """Return the inverse of `ship_table`; None without a table."""
    if table is None:
        return None
    particulars = number_table({name: v for name, v in table.items() if name not in ("name", "source", "scale")})
    return Ship(str(table["name"]), particulars, str(table["source"]), finite_number(table["scale"], "scale"))


def parameter_table(p: Parameter) -> dict[str, Any]:
    """Return the table of one parameter; what is infinite or empty is left out."""
    table: dict[str, Any] = {"value": float(p.value), "unit": p.unit, "free": p.free}
    bounds = {"lower": float(p.lower), "upper": float(p.upper)}
    table |= {key: bound for key, bound in bounds.items() if math.isfinite(bound)}
    if p.scale:
        table["scale"] = float(p.scale)
    if p.prior is not None:
        mean, deviation = float(p.prior.mean), float(p.prior.standard_deviation)
        table["prior"] = {"mean": mean, "sd": deviation, "source": p.prior.source}
    texts = {"meaning": p.meaning, "source": p.source, "latex": p.latex}
    return table | {key: text for key, text in texts.items() if text}


def parameter(name: str, table: Mapping[str, Any]) -> Parameter:
    """Return the inverse of `parameter_table`."""
    prior = table.get("prior")
    return Parameter(
        name=name,
        value=_value(table["value"], f"{name}.value"),
        unit=str(table["unit"]),
        lower=_bound(table.get("lower", -math.inf), f"{name}.lower"),
        upper=_bound(table.get("upper", math.inf), f"{name}.upper"),
        scale=finite_number(table.get("scale", 0.0), f"{name}.scale"),
        prior=None if prior is None else _prior(prior, f"{name}.prior"),
        free=bool(table["free"]),
        source=str(table.get("source", "")),
        meaning=str(table.get("meaning", "")),
        latex=str(table.get("latex", "")),
    )


def _value(number: Any, where: str) -> float:
    """A parameter's value; NaN where it has none yet."""
    return math.nan if isinstance(number, float) and math.isnan(number) else finite_number(number, where)


def _bound(number: Any, where: str) -> float:
    """A parameter's bound; infinite where there is none."""
    return number if isinstance(number, float) and math.isinf(number) else finite_number(number, where)


def _prior(table: Mapping[str, Any], where: str) -> Prior:
    deviation = finite_number(table["sd"], f"{where}.sd")
    if not deviation > 0.0:
        raise ValueError(f"{where}.sd = {deviation:g} is not positive")
    return Prior(finite_number(table["mean"], f"{where}.mean"), deviation, str(table["source"]))
