"""The model file: TOML, human-readable; what `identify` writes, `simulate` reads, the next fit takes as priors."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis, SessionOffset, Waves
from seatrial.core.results.coefficients import KINDS
from seatrial.core.values import Array, InputError, Parameter, Parameters, Prior, Ship, frozen
from seatrial.core.values.files import parse_toml, read_table_text, write_atomically
from seatrial.data.trial.priors import EarlierResult, JointPrior
from seatrial.physics.models import model_named
from seatrial.physics.sensors import Sensors, with_sensors
from seatrial.physics.simulate.steer import RUDDER_RATE, RudderRate, rudder_rate

# Ship, parameters, provenance, covariances and the basis of intervals as tables of a model file and back.

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


# The model file: TOML, human-readable; what `identify` writes, `simulate` reads. It holds values, never equations.

FORMAT = 1
EARLIER_MODEL_NAMES = {"heave_pitch_held": "heave_pitch_zoh"}
"""Name of a model in older files -> its name today."""
EARLIER_HASHES = {
    "d022a3005b5d29afd2fc92242e7ab6656ca7e988b9145f610ee9406e2d514b19":
        "3d303f461f66a0bcb49e760eb51abc143d419544205fddf72d17549ec3773eb2",
    "786c8cc350b9646c51e551f47900daf14c7f3e34b598e760f89ed56c77843e42":
        "9a8b6f6c8af885194efe1e03d4d371fe890c095ecee247b74c9069efcb5961df",
}  # fmt: skip
"""Hash of the same equations under an older name, or written with other rounding -> their hash today."""
CONVENTIONS = (
    "SI units and radians; x forward, y starboard, z down, psi clockwise; "
    "unit '1' marks a coefficient made nondimensional as its model's source says"
)


@dataclass(frozen=True, eq=False)
class ModelFile:
    """What a model file holds.

    Attributes:
        model: equations and parameters.
        covariance: of the free parameters in order, shape (n, n), or empty (0, 0).
        provenance: where the values come from.
        ship: the ship of the trials; None where the model is of no ship.
        approach: steady state and inputs from which a manoeuvre starts by default, symbol -> SI value.
        interval_basis: what intervals of predictions are made of; None where none were estimated.
        offsets: by which the inputs of the fit's sessions were logged wrong, and parameters that each session has.
        waves: that the sensors of the training runs showed.
    """

    model: Model
    covariance: Array = field(default_factory=lambda: frozen(np.empty((0, 0))))
    provenance: ModelProvenance = field(default_factory=ModelProvenance)
    ship: Ship | None = None
    approach: Mapping[str, float] = field(default_factory=dict)
    interval_basis: IntervalBasis | None = None
    offsets: tuple[SessionOffset, ...] = ()
    waves: tuple[Waves, ...] = ()

    @property
    def rudder_rate(self) -> RudderRate:
        """The rate that manoeuvres are steered with: of the training runs, or what SOLAS requires."""
        envelope = {} if self.interval_basis is None else self.interval_basis.training_envelope
        return rudder_rate(self.ship.scale if self.ship else 1.0, envelope.get(RUDDER_RATE))


def model_text(file: ModelFile) -> str:
    """Return the file's text; numbers are written so that they read back to the last bit."""
    model, covariance = file.model, file.covariance
    free = model.parameters.free_names
    if covariance.size and covariance.shape != (len(free), len(free)):
        raise ValueError(f"covariance of shape {covariance.shape} for {len(free)} free parameters")
    equations = {"name": model.name, "equation_hash": model.equation_hash, "source": model.equations.source}
    parts = {"layout": model.equations.layout, "sensors": model.equations.sensors}
    equations |= {key: text for key, text in parts.items() if text}
    held = {"held": sorted(model.held)} if model.held else {}
    table: dict[str, Any] = {"format": FORMAT, "model": equations | held | {"conventions": CONVENTIONS}}
    if file.ship is not None:
        table["ship"] = ship_table(file.ship)
    table["approach"] = number_table(file.approach)
    table["parameters"] = {p.name: parameter_table(p) for p in model.parameters}
    if covariance.size:
        table["covariance"] = {"parameters": list(free), "rows": matrix_rows(covariance)}
    if file.offsets:
        table["offsets"] = [offset_table(offset) for offset in file.offsets]
    if file.waves:
        table["waves"] = [asdict(wave) for wave in file.waves]
    if file.interval_basis is not None:
        table["interval_basis"] = interval_basis_table(file.interval_basis)
    return tomli_w.dumps(table | {"provenance": provenance_table(file.provenance)})


def write_model(file: ModelFile, path: str | Path) -> None:
    """Write `model_text` to a file, all of it or nothing.

    Raises:
        InputError: the place cannot be written.
    """
    write_atomically(Path(path), model_text(file).encode())


def read_model(path: str | Path, own_model: Model | None = None) -> Model:
    """Return the model of a model file.

    Args:
        path: a ``model.toml``.
        own_model: equations that are not built in.

    Raises:
        InputError: no such file, no model file, unknown equations, or equations that have changed since.
    """
    return read_model_file(path, own_model).model


def read_model_file(path: str | Path, own_model: Model | None = None) -> ModelFile:
    """Return all that a model file holds; arguments and errors as in `read_model`."""
    path = Path(path)
    try:
        text = read_table_text(path)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"model file '{path}' cannot be read ({reason}); check the path") from None
    return parse_model(text, str(path), own_model)


def parse_model(text: str, where: str, own_model: Model | None = None) -> ModelFile:
    """Return the inverse of `model_text`; errors as in `read_model`, naming the file as `where`."""
    try:
        table = parse_toml(text)
    except ValueError as error:
        raise InputError(f"model file '{where}' is no valid TOML: {error}") from None
    if table.get("format") != FORMAT or not isinstance(table.get("model"), dict):
        raise InputError(
            f"'{where}' is no seatrial model file of format {FORMAT}; give the model.toml of a result folder"
        )
    try:
        return _model_file(table, where, own_model)
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"model file '{where}' is damaged: {error}; write it again with 'seatrial identify'") from None


def _model_file(table: Mapping[str, Any], where: str, own_model: Model | None) -> ModelFile:
    model = _model_with_equations(table["model"], where, own_model)
    items = tuple(parameter(name, entry) for name, entry in table["parameters"].items())
    if tuple(p.name for p in items) != model.parameters.names:
        raise InputError(f"model file '{where}': its parameters are not those of model '{model.name}'")
    parameters = Parameters(items)
    covariance = covariance_matrix(table.get("covariance", {}).get("rows", []), f"{where}': covariance")
    if covariance.size and len(covariance) != len(parameters.free):
        raise ValueError(f"covariance has {len(covariance)} rows for {len(parameters.free)} free parameters")
    if table["provenance"]["method"]:  # of a fit, so that every free parameter was estimated
        for p in parameters.free:
            finite_number(p.value, f"parameters.{p.name}.value")
    return ModelFile(
        model.with_parameters(parameters),
        covariance,
        provenance(table["provenance"]),
        ship(table.get("ship")),
        number_table(table["approach"]),
        interval_basis(table, where, parameters),
        tuple(session_offset(row, model.input_names, parameters) for row in table.get("offsets", ())),
        tuple(_waves(one) for one in table.get("waves", ())),
    )


def _waves(entry: Mapping[str, Any]) -> Waves:
    numbers = {name: finite_number(entry[name], f"waves.{name}") for name in ("frequency", "damping")}
    return Waves(**numbers, rms={c: finite_number(v, f"waves.rms.{c}") for c, v in entry["rms"].items()})


def _model_with_equations(entry: Mapping[str, Any], where: str, own_model: Model | None) -> Model:
    name = EARLIER_MODEL_NAMES.get(str(entry["name"]), str(entry["name"]))
    if own_model is not None and own_model.name == name:
        model = own_model
    else:
        try:
            model = model_named(name, str(entry.get("layout", "")))
            if "sensors" in entry:
                model = with_sensors(model, Sensors.from_text(str(entry["sensors"])))
        except InputError as error:
            raise InputError(f"model file '{where}': {error}; give a model of your own with --model FILE.py") from None
    equation_hash = str(entry["equation_hash"])
    if model.equation_hash != EARLIER_HASHES.get(equation_hash, equation_hash):
        raise InputError(
            f"model file '{where}' was written for other equations of model '{name}' "
            f"(hash {equation_hash[:12]}, here {model.equation_hash[:12]}); identify again"
        )
    return model.with_held(str(name) for name in entry.get("held", ()))


# The result of an earlier fit as priors of the next one.

_LEAST_SHRINKAGE = 0.01
"""Share of the variances that is added to a covariance before it becomes a prior, at least; chosen."""


def read_earlier_result(folder: Path, own_model: Model | None = None) -> EarlierResult:
    """Return the free coefficients of a result's model file as a joint prior, and the files behind it.

    Raises:
        InputError: no model file, or one that states no uncertainty.
    """
    file = read_model_file(folder / "model.toml", own_model)
    free = file.model.parameters.free
    if file.covariance.shape != (len(free), len(free)) or not len(free):
        raise InputError(f"'{folder / 'model.toml'}' states no uncertainty; priors need the covariance of a fit")
    source = f"fit in {folder.name}, {len(file.provenance.records)} records"
    digests = frozenset(r.sha256 for r in file.provenance.records if r.sha256 and r.role == "training")
    return EarlierResult(file.model.name, source, joint_prior(file), digests)


def joint_prior(file: ModelFile) -> JointPrior:
    """Return the determined free coefficients with their covariance, a little wider than it is stated.

    A covariance of few runs knows some combinations too well by chance. A share of the variances is added to them, one
    over the degrees of freedom, so that no combination is taken for better known than it was (Ledoit & Wolf 2004,
    J. Multivar. Anal. 88, 365, whose target is a diagonal, too).
    """
    free, variances = file.model.parameters.free, np.diag(file.covariance)
    rows = np.flatnonzero(np.isfinite(file.covariance).all(axis=0) & (variances > 0.0))
    degrees = file.interval_basis.degrees_of_freedom if file.interval_basis else np.inf
    share = max(_LEAST_SHRINKAGE, 1.0 / degrees)
    covariance = file.covariance[np.ix_(rows, rows)] + share * np.diag(variances[rows])
    return JointPrior(tuple(free[i].name for i in rows), np.array([free[i].value for i in rows]), covariance)
