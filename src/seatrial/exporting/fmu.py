"""FMI 2.0 for co-simulation: the exported C with the functions of the interface, and its check by FMPy."""

import hashlib
import io
import math
import os
import shutil
import struct
import subprocess
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from seatrial.core.equations.model import ZERO_BY_DEFAULT
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, Array, Channel, InputError, Provenance, Record, RecordKind, frozen
from seatrial.data.read.log import require_library
from seatrial.exporting.c_source import export_c
from seatrial.exporting.source import (
    RANGE_USE,
    Export,
    ExportSource,
    Variable,
    identified_range,
    input_variables,
    output_variables,
    parameter_variables,
    plain,
    provenance_lines,
    range_text,
    rendered,
    state_variables,
)
from seatrial.numerics.kernels.integrate import DIVERGED
from seatrial.numerics.platform import library_suffix, system_name

if TYPE_CHECKING:
    from fmpy.fmi2 import FMU2Slave
    from fmpy.model_description import ModelDescription, ScalarVariable


# FMI 2.0 for co-simulation: the exported C with the functions of the interface, compiled for this platform.

MAX_STEP = "max_step"
_STEP = 0.1  # s, internal step: that of `simulate`
_OUTSIDE = "outside_identified_range"
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip file holds, so that the same model gives the same bytes
_BASE_UNITS = {
    "m": {"m": 1}, "m/s": {"m": 1, "s": -1}, "m/s^2": {"m": 1, "s": -2}, "rad": {"rad": 1}, "s": {"s": 1},
    "rad/s": {"rad": 1, "s": -1}, "rps": {"s": -1}, "1/s": {"s": -1}, "kg": {"kg": 1}, "kg m^2": {"kg": 1, "m": 2},
    "N": {"kg": 1, "m": 1, "s": -2}, "N m": {"kg": 1, "m": 2, "s": -2}, "kg/m^3": {"kg": 1, "m": -3}, "m^2": {"m": 2},
}  # fmt: skip
"""Unit -> exponents of SI base units; others are named only."""
_DISPLAY_UNITS = {"rad": ("deg", math.degrees(1.0)), "rad/s": ("deg/s", math.degrees(1.0))}
_OPTIONS = ("-O2", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC", "-fvisibility=hidden")


@dataclass(frozen=True)
class FmuVariable:
    """A real variable of modelDescription.xml; its value reference is its place."""

    name: str
    unit: str
    note: str
    causality: str
    variability: str = "continuous"
    initial: str = ""
    start: float | None = None
    min: float | None = None
    max: float | None = None


def export_fmu(source: ExportSource, name: str) -> Export:
    """Return ``name.fmu``: description, C sources and, where there is a compiler, the binary for this platform.

    Raises:
        InputError: a name is no C identifier or belongs to the FMU, or a parameter has no value.
    """
    files = {f"sources/{n}": content for n, content in export_c(source, name).files.items()}
    values = _template_values(source, name, files)
    files["sources/fmu.c"] = rendered("fmu.c", **values)
    files["modelDescription.xml"] = rendered("modelDescription.xml", **values)
    binary, note = compiled_binary(files, name)
    if binary:
        files[f"binaries/{platform_folder()}/{name}{library_suffix()}"] = binary
    return Export({f"{name}.fmu": _zipped(files)}, (note, range_text(source)))


def variables(source: ExportSource) -> tuple[FmuVariable, ...]:
    """Return the real variables: states, inputs, outputs, parameters, the internal step and the use of the range.

    Raises:
        InputError: the model has a name of the FMU's own.
    """
    model, approach = source.model, source.file.approach

    def start(variable: Variable) -> float:
        return float(approach.get(variable.name, 0.0))

    rows = [
        *(
            FmuVariable(v.name, v.unit, v.note, "output", initial="exact", start=start(v))
            for v in state_variables(model)
        ),
        *(FmuVariable(v.name, v.unit, v.note, "input", start=start(v)) for v in input_variables(model)),
        *(FmuVariable(v.name, v.unit, v.note, "output", initial="calculated") for v in output_variables(model)),
    ]
    for v, p in zip(parameter_variables(model), model.parameters, strict=True):
        low, high = (x if math.isfinite(x) else None for x in (p.lower, p.upper))
        rows.append(FmuVariable(v.name, v.unit, v.note, "parameter", "tunable", "exact", p.value, low, high))
    rows.append(FmuVariable(MAX_STEP, "s", "longest internal step", "parameter", "tunable", "exact", _STEP))
    if identified_range(source):
        note = f"above 1 outside the identified range. {range_text(source)}"
        rows.append(FmuVariable(RANGE_USE, "", note, "output", initial="calculated"))
    names = [row.name for row in rows]
    clash = next((n for n in (MAX_STEP, RANGE_USE, _OUTSIDE) if names.count(n) + (n == _OUTSIDE) > 1), "")
    if clash:
        raise InputError(f"'{clash}' of model '{model.name}' is a name of the FMU's own; rename it in the model")
    return tuple(rows)


def compiled_binary(files: dict[str, bytes], name: str) -> tuple[bytes, str]:
    """Return the library for this platform and a sentence on it; no bytes where it cannot be compiled."""
    sources = "the FMU holds C sources only, which most importers compile"
    compiler = next((c for c in (os.environ.get("CC", ""), "cc", "gcc", "clang") if c and shutil.which(c)), None)
    if compiler is None:
        return b"", f"No C compiler was found: {sources}; install gcc or set CC to have the binary as well."
    with tempfile.TemporaryDirectory() as place:
        for path, content in files.items():
            if path.startswith("sources/"):
                (Path(place) / Path(path).name).write_bytes(content)
        command = [compiler, *_OPTIONS, "fmu.c", f"{name}.c", "-o", "binary", "-lm"]
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            reason = printable(next(iter(done.stderr.splitlines()), "no message"))
            return b"", f"The C compiler '{compiler}' failed ({reason}): {sources}."
        return (Path(place) / "binary").read_bytes(), f"Binary for {platform_folder()}, compiled by {compiler}."


def platform_folder() -> str:
    """Return the folder of this platform's binary in an FMU (FMI 2.0, section 2.3)."""
    return f"{system_name()}{8 * struct.calcsize('P')}"


def _template_values(source: ExportSource, name: str, files: dict[str, bytes]) -> dict[str, object]:
    model, rows = source.model, variables(source)
    has_range = rows[-1].name == RANGE_USE
    indices = [i for i, row in enumerate(rows, start=1) if row.causality == "output"]
    calculated = [i for i in indices if rows[i - 1].initial == "calculated"]
    last = [len(rows) + 1] if has_range else []
    bounds = [(p.lower, p.upper) for p in model.parameters]
    units = sorted({row.unit for row in rows if row.unit})
    return {
        "name": name,
        "NAME": name.upper(),
        "guid": hashlib.sha256(b"\0".join(files.values())).hexdigest()[:32],  # of 32 digits, as a GUID has
        "date": source.date,
        "head": [*provenance_lines(source), range_text(source)],
        "description": plain(f"{model.equations.meaning or model.name}; {range_text(source)}"),
        "equations": model.equation_hash,
        "reversed": " ".join(i.name for i in model.inputs if i.is_reversed),
        "variables": rows,
        "units": [(unit, _BASE_UNITS.get(unit), _DISPLAY_UNITS.get(unit)) for unit in units],
        "has_range": has_range,
        "is_affine": model.is_affine,
        "output_indices": indices + last,
        "initial_indices": calculated + last,
        "start_x": ", ".join(repr(float(row.start or 0.0)) for row in rows[: len(model.states)]),
        "start_u": ", ".join(repr(float(source.file.approach.get(n, 0.0))) for n in (*model.input_names, "")),
        "lower": ", ".join([*(_c_number(low) for low, _ in bounds), "0.0"]),
        "upper": ", ".join([*(_c_number(high) for _, high in bounds), "0.0"]),
        "max_step": _STEP,
        "real_count": len(rows),
        "diverged": DIVERGED,
    }


def _c_number(value: float) -> str:
    return repr(value) if math.isfinite(value) else ("-" if value < 0.0 else "") + "HUGE_VAL"


def _zipped(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            archive.writestr(zipfile.ZipInfo(path, _ZIP_DATE), content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


# An FMU run by FMPy with the inputs of a record: the check that an exported model moves as the model does.


def replay_fmu(path: Path, record: Record) -> Record:
    """Return the run of an FMU for co-simulation under the inputs of a record, straight between its samples.

    Inputs, and states at the first sample, are the channels of the same name; states without one start as the FMU says.

    Raises:
        InputError: no FMU, none for co-simulation or this platform, an input that the record lacks, a step that fails,
            or FMPy is not installed.
    """
    require_library("fmpy", f"'{path}'", "an FMU", "fmu")
    with _instance(path) as (description, fmu, log):
        inputs = [v for v in description.modelVariables if v.causality == "input" and v.type == "Real"]
        outputs = [v for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
        signs = _signs(path)
        driven = np.column_stack(
            [_input_values(record, v, signs, path) for v in inputs] or [np.empty((len(record), 0))]
        )
        starts = {v: float(record[v.name][0]) for v in outputs if v.initial == "exact" and v.name in record}
        try:
            values = _run(fmu, inputs, outputs, starts, driven, record.dt)
        except Exception as error:  # FMPy raises its own and those of ctypes
            reason = log[-1] if log else str(error)
            raise InputError(f"FMU '{path}' stopped on record '{record.name}': {printable(reason)}") from None
    channels = {v.name: _channel(v.name, values[:, k] * signs.get(v.name, 1.0)) for k, v in enumerate(outputs)}
    channels |= {v.name: record.channel(v.name) for v in inputs if v.name in record}
    provenance = Provenance(str(path), steps=(f"inputs of '{record.name}' replayed through the FMU by FMPy",))
    return Record(record.name, record.time, channels, RecordKind.SIMULATED, provenance=provenance)


@contextmanager
def _instance(path: Path) -> "Iterator[tuple[ModelDescription, FMU2Slave, list[str]]]":
    """The unpacked FMU's description, an instance of it, and the messages that it logs."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    log: list[str] = []
    with tempfile.TemporaryDirectory() as place:
        try:
            description = fmpy.read_model_description(str(path))
            if description.coSimulation is None or description.fmiVersion != "2.0":
                raise InputError(f"FMU '{path}' is not one of FMI 2.0 for co-simulation; export it so")
            fmpy.extract(str(path), unzipdir=place)
            identifier = description.coSimulation.modelIdentifier
            fmu = FMU2Slave(guid=description.guid, unzipDirectory=place, modelIdentifier=identifier, instanceName="run")
            fmu.instantiate(callbacks=_callbacks(log))
        except InputError:
            raise
        except Exception as error:  # whatever a damaged archive, description or library raises
            reason = printable(" ".join(str(error).split()))
            raise InputError(f"'{path}' cannot be run as an FMU on this platform ({reason})") from None
        try:
            yield description, fmu, log
        finally:
            fmu.freeInstance()


def _callbacks(log: list[str]) -> object:
    from fmpy import calloc, free
    from fmpy.fmi2 import (
        fmi2CallbackAllocateMemoryTYPE,
        fmi2CallbackFreeMemoryTYPE,
        fmi2CallbackFunctions,
        fmi2CallbackLoggerTYPE,
    )

    def logged(
        _environment: object, _name: bytes, _status: int, _category: bytes, message: bytes, *_more: object
    ) -> None:
        log.append(message.decode("utf-8", "replace"))

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = fmi2CallbackLoggerTYPE(logged)
    callbacks.allocateMemory, callbacks.freeMemory = (
        fmi2CallbackAllocateMemoryTYPE(calloc),
        fmi2CallbackFreeMemoryTYPE(free),
    )
    return callbacks


def _run(
    fmu: "FMU2Slave", inputs: "list[ScalarVariable]", outputs: "list[ScalarVariable]",
    starts: "dict[ScalarVariable, float]", driven: Array, dt: float,
) -> Array:  # fmt: skip
    """Return the outputs at each row of the inputs, shape (n, ny)."""
    references = [v.valueReference for v in inputs]
    rows = np.empty((len(driven), len(outputs)))
    fmu.setupExperiment(startTime=0.0)
    fmu.setReal([v.valueReference for v in starts], list(starts.values()))
    fmu.enterInitializationMode()
    fmu.setReal(references, driven[0].tolist())
    fmu.exitInitializationMode()
    for k, row in enumerate(driven):
        fmu.setReal(references, row.tolist())
        rows[k] = fmu.getReal([v.valueReference for v in outputs])
        if k + 1 < len(driven):
            slopes = ((driven[k + 1] - row) / dt).tolist()
            fmu.setRealInputDerivatives(references, [1] * len(references), slopes)
            fmu.doStep(currentCommunicationPoint=k * dt, communicationStepSize=dt)
    return rows


def _signs(path: Path) -> dict[str, float]:
    """Inputs that the model counts against the notation's sign -> -1, as the annotation of an exported FMU says."""
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    annotation = root.find("./VendorAnnotations/Tool[@name='seatrial']/Model")
    return {} if annotation is None else dict.fromkeys(annotation.get("reversed", "").split(), -1.0)


def _input_values(record: Record, variable: "ScalarVariable", signs: dict[str, float], path: Path) -> Array:
    name = variable.name
    if name not in record:
        if name in ZERO_BY_DEFAULT:
            return np.zeros(len(record))
        raise InputError(f"record '{record.name}' has no channel '{name}', an input of FMU '{path}'; add it")
    if not np.isfinite(record[name]).all():
        raise InputError(f"record '{record.name}': input channel '{name}' has gaps; repair it first")
    return record[name] * signs.get(name, 1.0)


def _channel(name: str, values: Array) -> Channel:
    if name in NOTATION:
        return Channel.from_notation(name, frozen(np.ascontiguousarray(values)))
    return Channel(frozen(np.ascontiguousarray(values)), "1", "none", "none")
