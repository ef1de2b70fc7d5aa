"""The model file: TOML, human-readable; what `identify` writes, `simulate` reads. It holds values, never equations.

The equations are known by name and hash: a built-in model is found by its name, any other is handed in.
"""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis
from seatrial.core.values import Array, InputError, Parameter, Parameters, Prior, Record, Ship, frozen
from seatrial.core.values.files import write_atomically
from seatrial.physics.models import model_named

FORMAT = 1
_ROUNDING, _ASYMMETRY = 1e-8, 1e-6
_TABLES_OF_MARGIN = ("measure_deviation", "offsets", "process", "training_envelope")
CONVENTIONS = (
    "SI units and radians; x forward, y starboard, z down, psi clockwise; "
    "unit '1' marks a coefficient made nondimensional as its model's source says"
)


@dataclass(frozen=True)
class ModelProvenance:
    """Where a model's values come from.

    Attributes:
        records: (name, role, sha256) of every record used.
        method: criterion in words.
        seed: of the estimate.
        versions: package -> version.
    """

    records: tuple[tuple[str, str, str], ...] = ()
    method: str = ""
    seed: int | None = None
    versions: Mapping[str, str] | None = None


@dataclass(frozen=True, eq=False)
class ModelFile:
    """What a model file holds.

    Attributes:
        covariance: of the free parameters in order, shape (n, n), or empty (0, 0).
        approach: steady state and inputs from which a manoeuvre starts by default, symbol -> SI value.
        margin: what intervals of predictions are made of; None where nobody estimated any.
    """

    model: Model
    covariance: Array = field(default_factory=lambda: frozen(np.empty((0, 0))))
    provenance: ModelProvenance = ModelProvenance()
    ship: Ship | None = None
    approach: Mapping[str, float] = field(default_factory=dict)
    interval_basis: IntervalBasis | None = None


def model_provenance(
    records: Sequence[tuple[Record, str]], method: str, seed: int, versions: Mapping[str, str]
) -> ModelProvenance:
    """Provenance from (record, role) pairs."""
    rows = tuple((record.name, role, record.provenance.sha256) for record, role in records)
    return ModelProvenance(rows, method, seed, dict(versions))


def model_text(file: ModelFile) -> str:
    """The file's text; numbers are written so that they read back to the last bit."""
    model, covariance = file.model, file.covariance
    free = model.parameters.free_names
    if covariance.size and covariance.shape != (len(free), len(free)):
        raise ValueError(f"covariance of shape {covariance.shape} for {len(free)} free parameters")
    about = {"name": model.name, "equation_hash": model.equation_hash, "source": model.equations.source}
    table: dict[str, Any] = {"format": FORMAT, "model": about | {"conventions": CONVENTIONS}}
    if file.ship is not None:
        ship = file.ship
        table["ship"] = {
            "name": ship.name,
            "source": ship.source,
            "scale": float(ship.scale),
            **_floats(ship.particulars),
        }
    table["approach"] = _floats(file.approach)
    table["parameters"] = {p.name: _parameter_table(p) for p in model.parameters}
    if covariance.size:
        table["covariance"] = {"parameters": list(free), "rows": _rows(covariance)}
    if file.interval_basis is not None:
        table["interval_basis"] = _uncertainty_table(file.interval_basis)
    return tomli_w.dumps(table | {"provenance": _provenance_table(file.provenance)})


def _rows(matrix: Array) -> list[list[float]]:
    return [[float(c) for c in row] for row in matrix]


def _uncertainty_table(margin: IntervalBasis) -> dict[str, Any]:
    return {
        "degrees_of_freedom": float(margin.degrees_of_freedom),
        "factor": float(margin.factor),
        "covariance": _rows(margin.covariance),
        "tied": [_floats(one) for one in margin.tied],
        **{name: _floats(getattr(margin, name)) for name in _TABLES_OF_MARGIN},
    }


def _uncertainty(table: Mapping[str, Any], where: str, parameters: Parameters) -> IntervalBasis | None:
    if "interval_basis" not in table:
        return None
    entry = table["interval_basis"]
    degrees, tied = float(entry["degrees_of_freedom"]), tuple(_floats(one) for one in entry["tied"])
    covariance = _covariance_matrix(entry["covariance"], f"{where}': interval_basis.covariance")
    if len(covariance) != len(parameters.free):
        raise ValueError(
            f"interval_basis.covariance has {len(covariance)} rows for {len(parameters.free)} free parameters"
        )
    if not degrees > 0.0:
        raise ValueError(f"interval_basis.degrees_of_freedom is {degrees:g}")
    if strangers := [name for one in tied for name in one if name not in parameters]:
        raise ValueError(f"interval_basis.tied names '{strangers[0]}', which is no parameter of the model")
    tables = {name: _floats(entry[name]) for name in _TABLES_OF_MARGIN}
    return IntervalBasis(covariance, degrees, float(entry["factor"]), tied=tied, **tables)


def _floats(numbers: Mapping[str, float]) -> dict[str, float]:
    return {name: float(number) for name, number in numbers.items()}


def write_model(file: ModelFile, path: str | Path) -> None:
    """Write `model_text` to a file, whole or not at all.

    Raises:
        InputError: the place cannot be written.
    """
    write_atomically(Path(path), model_text(file).encode())


def read_model(path: str | Path, own_model: Model | None = None) -> Model:
    """The model of a model file.

    Args:
        own_model: equations that are not built in.

    Raises:
        InputError: no such file, no model file, unknown equations, or equations that have changed since.
    """
    return read_model_file(path, own_model).model


def read_model_file(path: str | Path, own_model: Model | None = None) -> ModelFile:
    """The model, its covariance and provenance; raises as `read_model`."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise InputError(f"model file '{path}' cannot be read ({reason}); check the path") from None
    return parse_model(text, str(path), own_model)


def parse_model(text: str, where: str, own_model: Model | None = None) -> ModelFile:
    """The inverse of `model_text`; raises as `read_model`."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"model file '{where}' is no valid TOML: {error}") from None
    if table.get("format") != FORMAT or not isinstance(table.get("model"), dict):
        raise InputError(
            f"'{where}' is no seatrial model file of format {FORMAT}; give the model.toml of a result folder"
        )
    try:
        model = _model_with_equations(table["model"], where, own_model)
        items = tuple(_parameter(name, entry) for name, entry in table["parameters"].items())
        if tuple(p.name for p in items) != model.parameters.names:
            raise InputError(f"model file '{where}': its parameters are not those of model '{model.name}'")
        covariance = _covariance_matrix(table.get("covariance", {}).get("rows", []), f"{where}': covariance")
        provenance = _provenance(table["provenance"])
        approach = {name: float(value) for name, value in table["approach"].items()}
        made = model.with_parameters(Parameters(items))
        if covariance.size and len(covariance) != len(made.parameters.free):
            raise ValueError(f"covariance has {len(covariance)} rows for {len(made.parameters.free)} free parameters")
        return ModelFile(
            made, covariance, provenance, _ship(table), approach, _uncertainty(table, where, made.parameters)
        )
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"model file '{where}' is damaged: {error}; write it again with 'seatrial identify'") from None


def _ship(table: Mapping[str, Any]) -> Ship | None:
    if "ship" not in table:
        return None
    particulars = {n: float(v) for n, v in table["ship"].items() if n not in ("name", "source", "scale")}
    return Ship(table["ship"]["name"], particulars, table["ship"]["source"], float(table["ship"]["scale"]))


def _covariance_matrix(rows: Sequence[Sequence[float]], where: str) -> Array:
    """A covariance; one that is not finite, not symmetric, or negative in any direction beyond rounding is refused."""
    matrix = np.array(rows, dtype=float).reshape(len(rows), len(rows))
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    size = np.outer(scale, scale)
    if not np.all(np.isfinite(matrix)) or np.any(np.abs(matrix - matrix.T) > _ASYMMETRY * size):
        raise InputError(
            f"model file '{where} is not a symmetric matrix of finite numbers; "
            "write the file again with 'seatrial identify'"
        )
    smallest = float(np.min(np.linalg.eigvalsh(matrix / size))) if len(rows) else 0.0
    if not smallest > -_ROUNDING:
        raise InputError(
            f"model file '{where} is not positive definite (smallest eigenvalue {smallest:.3g} of its correlation "
            "matrix); write the file again with 'seatrial identify'"
        )
    return frozen(matrix)


def _model_with_equations(entry: Mapping[str, Any], where: str, own_model: Model | None) -> Model:
    name = str(entry["name"])
    if own_model is not None and own_model.name == name:
        model = own_model
    else:
        try:
            model = model_named(name)
        except InputError as error:
            raise InputError(f"model file '{where}': {error}; give a model of your own with --model FILE.py") from None
    if model.equation_hash != entry["equation_hash"]:
        raise InputError(
            f"model file '{where}' was written for other equations of model '{name}' "
            f"(hash {str(entry['equation_hash'])[:12]}, here {model.equation_hash[:12]}); identify again"
        )
    return model


def _parameter_table(p: Parameter) -> dict[str, Any]:
    table: dict[str, Any] = {"value": float(p.value), "unit": p.unit, "free": p.free}
    bounds = {"lower": float(p.lower), "upper": float(p.upper)}
    table |= {key: bound for key, bound in bounds.items() if math.isfinite(bound)}
    if p.scale:
        table["scale"] = float(p.scale)
    if p.prior is not None:
        table["prior"] = {
            "mean": float(p.prior.mean),
            "sd": float(p.prior.standard_deviation),
            "source": p.prior.source,
        }
    return table | {
        key: text for key, text in (("meaning", p.meaning), ("source", p.source), ("latex", p.latex)) if text
    }


def _parameter(name: str, entry: Mapping[str, Any]) -> Parameter:
    prior = entry.get("prior")
    return Parameter(
        name=name,
        value=float(entry["value"]),
        unit=str(entry["unit"]),
        lower=float(entry.get("lower", -math.inf)),
        upper=float(entry.get("upper", math.inf)),
        scale=float(entry.get("scale", 0.0)),
        prior=None if prior is None else Prior(float(prior["mean"]), float(prior["sd"]), str(prior["source"])),
        free=bool(entry["free"]),
        source=str(entry.get("source", "")),
        meaning=str(entry.get("meaning", "")),
        latex=str(entry.get("latex", "")),
    )


def _provenance_table(provenance: ModelProvenance) -> dict[str, Any]:
    table: dict[str, Any] = {
        "method": provenance.method,
        "versions": dict(provenance.versions or {}),
        "records": [{"name": name, "role": role, "sha256": digest} for name, role, digest in provenance.records],
    }
    return table if provenance.seed is None else table | {"seed": provenance.seed}


def _provenance(table: Mapping[str, Any]) -> ModelProvenance:
    rows = tuple((str(r["name"]), str(r["role"]), str(r["sha256"])) for r in table["records"])
    return ModelProvenance(rows, str(table["method"]), table.get("seed"), dict(table["versions"]))
