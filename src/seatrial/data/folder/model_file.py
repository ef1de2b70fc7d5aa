"""The model file: TOML, human-readable; what `identify` writes, `simulate` reads. It holds values, never equations.

The equations are known by name and hash: a built-in model is found by its name, any other is handed in.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis, SessionOffset, Waves
from seatrial.core.values import Array, InputError, Parameters, Ship, frozen
from seatrial.core.values.files import write_atomically
from seatrial.core.values.tables import parse_toml, read_table_text
from seatrial.data.folder import model_tables
from seatrial.data.folder.model_tables import (
    ModelProvenance,
    covariance_matrix,
    finite_number,
    interval_basis,
    interval_basis_table,
    matrix_rows,
    number_table,
)
from seatrial.physics.models import model_named
from seatrial.physics.sensors import Sensors, with_sensors
from seatrial.physics.simulate.rudder_rate import RUDDER_RATE, RudderRate, rudder_rate

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
        table["ship"] = model_tables.ship_table(file.ship)
    table["approach"] = number_table(file.approach)
    table["parameters"] = {p.name: model_tables.parameter_table(p) for p in model.parameters}
    if covariance.size:
        table["covariance"] = {"parameters": list(free), "rows": matrix_rows(covariance)}
    if file.offsets:
        table["offsets"] = [model_tables.offset_table(offset) for offset in file.offsets]
    if file.waves:
        table["waves"] = [asdict(wave) for wave in file.waves]
    if file.interval_basis is not None:
        table["interval_basis"] = interval_basis_table(file.interval_basis)
    return tomli_w.dumps(table | {"provenance": model_tables.provenance_table(file.provenance)})


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
    items = tuple(model_tables.parameter(name, entry) for name, entry in table["parameters"].items())
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
        model_tables.provenance(table["provenance"]),
        model_tables.ship(table.get("ship")),
        number_table(table["approach"]),
        interval_basis(table, where, parameters),
        tuple(model_tables.session_offset(row, model.input_names, parameters) for row in table.get("offsets", ())),
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
